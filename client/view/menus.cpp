// SPDX-License-Identifier: Apache-2.0
#include "client/view/menus.h"

#include "client/render/draw_options.h"

#include "shared/silhouette/detector.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>

namespace limn {
namespace {

const std::vector<std::string>& detectors() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const DetectorMethod method : allDetectors())
      all.emplace_back(detectorName(method));
    return all;
  }();
  return names;
}

constexpr float kItemWidth = 150.0F;

const std::vector<std::string>& drawMethods() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const DrawMode mode : allDrawModes())
      all.emplace_back(nameOf(mode));
    return all;
  }();
  return names;
}

const std::vector<std::string> kSilhouettes = {"smooth", "edges"};
constexpr std::array kFeatures =
    {"crease", "border", "seam", "suggestive", "ridge", "valley", "intersection"};
const std::vector<std::string> kBrushes = {"none", "charcoal", "lazy", "hand", "rough"};
const std::vector<std::string> kHidden = {"style", "off", "as-visible"};

/// `step` places on from `now`, around the end.
std::string neighbour(const std::vector<std::string>& names, const std::string& now, int step) {
  if (names.empty()) return now;
  const auto count = static_cast<std::ptrdiff_t>(names.size());
  const auto found = std::ranges::find(names, now);
  const auto at = found == names.end() ? 0 : found - names.begin() + step;
  return names[static_cast<std::size_t>((at % count + count) % count)];
}

void combo(const char* label, const std::vector<std::string>& names, std::string& chosen) {
  if (!ImGui::BeginCombo(label, chosen.c_str())) return;
  for (const std::string& name : names) {
    if (ImGui::Selectable(name.c_str(), name == chosen)) chosen = name;
  }
  ImGui::EndCombo();
}

void sliderDouble(const char* label, double low, double high, const char* format, double& value) {
  ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &low, &high, format);
}

std::vector<std::string> readyModels(const MenuFacts& facts) {
  std::vector<std::string> names;
  for (const CatalogueEntry& entry : facts.catalogue) {
    if (entry.state == CatalogueEntry::State::kReady) names.push_back(entry.name);
  }
  return names;
}

struct Key {
  int glfw;
  const char* label;
  const char* what;
  void (*act)(const MenuFacts& facts, ViewChoices& choices, MenuActions& actions);
};

const std::array<Key, 16> kKeys = {{
    {GLFW_KEY_H, "H", "whole model", [](auto&, auto&, auto& a) { a.home = true; }},
    {GLFW_KEY_N,
     "N",
     "next model",
     [](auto& f, auto&, auto& a) { a.model = neighbour(readyModels(f), f.model, 1); }},
    {GLFW_KEY_B,
     "B",
     "model before",
     [](auto& f, auto&, auto& a) { a.model = neighbour(readyModels(f), f.model, -1); }},
    {GLFW_KEY_S,
     "S",
     "next style",
     [](auto& f, auto& c, auto&) { c.style = neighbour(f.styles, c.style, 1); }},
    {GLFW_KEY_A,
     "A",
     "style before",
     [](auto& f, auto& c, auto&) { c.style = neighbour(f.styles, c.style, -1); }},
    {GLFW_KEY_D,
     "D",
     "next detector",
     [](auto&, auto& c, auto&) { c.detector = neighbour(detectors(), c.detector, 1); }},
    {GLFW_KEY_W,
     "W",
     "next way to draw",
     [](auto&, auto& c, auto&) { c.draw = neighbour(drawMethods(), c.draw, 1); }},
    {GLFW_KEY_X,
     "X",
     "hidden lines",
     [](auto&, auto& c, auto&) { c.hidden = neighbour(kHidden, c.hidden, 1); }},
    {GLFW_KEY_O,
     "O",
     "orthographic or not",
     [](auto&, auto& c, auto&) { c.orthographic = !c.orthographic; }},
    {GLFW_KEY_L,
     "L",
     "silhouettes of a light",
     [](auto&, auto& c, auto&) { c.hasLight = !c.hasLight; }},
    {GLFW_KEY_T, "T", "timings", [](auto&, auto& c, auto&) { c.showsTimings = !c.showsTimings; }},
    {GLFW_KEY_M, "M", "menu", [](auto&, auto& c, auto&) { c.showsMenu = !c.showsMenu; }},
    {GLFW_KEY_P, "P", "save a picture (PNG)", [](auto&, auto&, auto& a) { a.savePng = true; }},
    {GLFW_KEY_V, "V", "save vectors (SVG)", [](auto&, auto&, auto& a) { a.saveSvg = true; }},
    {GLFW_KEY_R,
     "R",
     "record the camera's path, or stop",
     [](auto&, auto&, auto& a) { a.record = true; }},
    {GLFW_KEY_Q, "Q", "quit", [](auto&, auto&, auto& a) { a.quit = true; }},
}};

void showModels(const MenuFacts& facts, MenuActions& actions) {
  if (facts.catalogue.empty()) return;
  ImGui::SetNextItemOpen(true, ImGuiCond_Once);
  if (!ImGui::CollapsingHeader("Models")) return;
  const float rows = std::min<float>(8.0F, static_cast<float>(facts.catalogue.size()));
  ImGui::BeginChild("models", {2.0F * kItemWidth, rows * ImGui::GetTextLineHeightWithSpacing()});
  for (const CatalogueEntry& entry : facts.catalogue) {
    const bool isReady = entry.state == CatalogueEntry::State::kReady;
    if (ImGui::Selectable(
            entry.name.c_str(),
            entry.name == facts.model,
            isReady ? 0 : ImGuiSelectableFlags_Disabled)) {
      actions.model = entry.name;
    }
    if (entry.state == CatalogueEntry::State::kFailed && ImGui::IsItemHovered())
      ImGui::SetTooltip("%s", entry.reason.c_str());
    ImGui::SameLine(ImGui::GetContentRegionAvail().x * 0.6F);
    switch (entry.state) {
      case CatalogueEntry::State::kReady:
        ImGui::TextDisabled("%llu faces", static_cast<unsigned long long>(entry.faces));
        break;
      case CatalogueEntry::State::kPreparing:
        ImGui::TextDisabled("preparing, %.0f %%", 100.0 * entry.progress);
        break;
      case CatalogueEntry::State::kQueued:
        ImGui::TextDisabled("queued");
        break;
      case CatalogueEntry::State::kFailed:
        ImGui::TextDisabled("failed");
        break;
    }
  }
  ImGui::EndChild();
}

void showChoices(const MenuFacts& facts, ViewChoices& c) {
  ImGui::SetNextItemOpen(true, ImGuiCond_Once);
  if (ImGui::CollapsingHeader("Lines")) {
    combo("style", facts.styles, c.style);
    sliderDouble("width", 0.0, 12.0, c.widthPx > 0.0 ? "%.1f px" : "the style's", c.widthPx);
    sliderDouble("texture size", 0.25, 4.0, "%.2f x", c.textureSize);
    combo("brush", kBrushes, c.brush);
    combo("hidden lines", kHidden, c.hidden);
    combo("silhouettes", kSilhouettes, c.silhouette);
  }
  if (ImGui::CollapsingHeader("Features")) {
    for (const char* name : kFeatures) {
      bool isChosen = hasWord(c.features, name);
      if (ImGui::Checkbox(name, &isChosen)) c.features = toggled(c.features, name);
    }
  }
  if (ImGui::CollapsingHeader("Method")) {
    combo("drawing", drawMethods(), c.draw);
    if (c.draw == nameOf(DrawMode::kClip)) {
      ImGui::SliderInt(
          "hull faces",
          &c.hullFaces,
          kLeastHullFaces,
          kMostHullFaces,
          "%d",
          ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    }
    combo("detector", detectors(), c.detector);
    ImGui::Checkbox("as a light sees it", &c.hasLight);
    if (c.hasLight) {
      sliderDouble("azimuth", -180.0, 180.0, "%.0f deg", c.lightAzimuth);
      sliderDouble("elevation", -90.0, 90.0, "%.0f deg", c.lightElevation);
    }
  }
  if (ImGui::CollapsingHeader("Camera")) {
    sliderDouble("field of view", 5.0, 120.0, "%.0f deg", c.fovDegrees);
    ImGui::Checkbox("orthographic", &c.orthographic);
  }
}

void showFiles(const MenuFacts& facts, MenuActions& actions) {
  if (!ImGui::CollapsingHeader("Save")) return;
  if (ImGui::Button("picture (PNG)")) actions.savePng = true;
  ImGui::SameLine();
  if (ImGui::Button("vectors (SVG)")) actions.saveSvg = true;
  if (ImGui::Button(facts.isRecording ? "stop recording" : "record camera path"))
    actions.record = true;
  if (ImGui::Button("copy as command line")) actions.copyCommand = true;
}

void showStatus(const MenuFacts& facts, MenuActions& actions) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_AlwaysAutoResize |
                                      ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
  ImGui::SetNextWindowPos({8.0F, size.y - 8.0F}, ImGuiCond_Always, {0.0F, 1.0F});
  ImGui::SetNextWindowBgAlpha(0.7F);
  if (ImGui::Begin("status", nullptr, kPlain)) {
    if (!facts.complaint.empty()) {
      ImGui::PushTextWrapPos(0.8F * size.x);
      ImGui::TextUnformatted(facts.complaint.c_str());
      ImGui::PopTextWrapPos();
      if (ImGui::Button("try again")) actions.retry = true;
    } else {
      ImGui::Text(
          "%s   %s   %zu faces   %.1f kB",
          facts.model.c_str(),
          facts.state.c_str(),
          facts.faces,
          static_cast<double>(facts.bytes) / 1000.0);
      ImGui::ProgressBar(static_cast<float>(facts.share), {240.0F, 4.0F}, "");
      if (facts.isRecording) ImGui::TextUnformatted("recording the camera (R ends it)");
      if (!facts.notice.empty()) ImGui::TextUnformatted(facts.notice.c_str());
    }
    if (!facts.message.empty()) ImGui::TextUnformatted(facts.message.c_str());
  }
  ImGui::End();
}

void showTimings(const MenuFacts& facts) {
  ImGui::Text("detection  %6.2f ms", facts.detectMs);
  ImGui::Text("chaining   %6.2f ms", facts.chainMs);
  ImGui::Text("strokes    %6.2f ms", facts.strokeMs);
  ImGui::Text("visibility %6.2f ms", facts.visibilityMs);
  ImGui::Text("drawing    %6.2f ms", facts.drawMs);
  ImGui::Text("%zu segments", facts.segments);
  ImGui::Text("%d x %d, %d times finer", facts.width, facts.height, facts.supersample);
  ImGui::TextDisabled("%s", facts.gl.c_str());
}

}  // namespace

void Menus::showKeys() {
  if (!showsHelp_) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5F * size.x, 0.5F * size.y}, ImGuiCond_Appearing, {0.5F, 0.5F});
  if (ImGui::Begin("Keys and gestures", &showsHelp_, ImGuiWindowFlags_AlwaysAutoResize)) {
    ImGui::TextUnformatted("left drag             turn");
    ImGui::TextUnformatted("right or middle drag  slide");
    ImGui::TextUnformatted("wheel                 closer, away");
    ImGui::TextUnformatted("double click          fly there");
    ImGui::Separator();
    for (const Key& key : kKeys)
      ImGui::Text("%-2s  %s", key.label, key.what);
    ImGui::TextUnformatted("F1  this help");
  }
  ImGui::End();
}

MenuActions Menus::show(const MenuFacts& facts, ViewChoices& choices) {
  MenuActions actions;
  if (!ImGui::GetIO().WantTextInput) {
    for (const Key& key : kKeys) {
      if (ImGui::IsKeyPressed(key.glfw, false)) key.act(facts, choices, actions);
    }
    if (ImGui::IsKeyPressed(GLFW_KEY_F1, false)) showsHelp_ = !showsHelp_;
  }
  showStatus(facts, actions);
  if (choices.showsMenu) {
    ImGui::SetNextWindowPos({8.0F, 8.0F}, ImGuiCond_FirstUseEver);
    if (ImGui::Begin("Limn", &choices.showsMenu, ImGuiWindowFlags_AlwaysAutoResize)) {
      ImGui::PushItemWidth(kItemWidth);
      showModels(facts, actions);
      showChoices(facts, choices);
      showFiles(facts, actions);
      ImGui::Checkbox("timings", &choices.showsTimings);
      ImGui::SameLine();
      if (ImGui::Button("keys (F1)")) showsHelp_ = true;
      if (choices.showsTimings) showTimings(facts);
      ImGui::PopItemWidth();
    }
    ImGui::End();
  }
  showKeys();
  return actions;
}

}  // namespace limn
