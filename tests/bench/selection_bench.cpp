// SPDX-License-Identifier: Apache-2.0
// Bytes of a real server session (no socket) until a view is settled and until it is exact, from
// cold starts and further turns; how far the contours that its client then has are off; and how
// long choosing took. One JSON object on standard output.
#include "client/core/stream_decoder.h"
#include "server/session/contour_search.h"
#include "server/session/session.h"
#include "server/store/asset_store.h"
#include "tests/bench/measure.h"
#include "tests/bench/one_model.h"

#include "shared/core/camera.h"
#include "shared/silhouette/contour_distance.h"
#include "shared/silhouette/visible_contour.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

using protocol::Goal;

/// Runs work where it is asked for, on this thread, and times it.
class TimedTasks final : public TaskRunner {
 public:
  void submit(TaskUrgency, std::function<void()> work, std::function<void()> done) override {
    queue_.emplace_back(std::move(work), std::move(done));
  }

  [[nodiscard]] std::size_t pending() const override { return queue_.size(); }

  bool runAll() {
    if (queue_.empty()) return false;
    for (; !queue_.empty(); queue_.pop_front()) {
      const double begin = processCpuMs();
      queue_.front().first();
      longestMs_ = std::max(longestMs_, processCpuMs() - begin);
      queue_.front().second();
    }
    return true;
  }

  /// The longest piece of work since the last call.
  double takeLongestMs() { return std::exchange(longestMs_, 0.0); }

 private:
  std::deque<std::pair<std::function<void()>, std::function<void()>>> queue_;
  double longestMs_ = 0.0;
};

/// A client at the other end of a session, taking everything at once.
class Client final : public Peer {
 public:
  Client(const std::shared_ptr<const Model>& model, TimedTasks& tasks)
      : tasks_(tasks),
        models_(model),
        cells_(tasks, {}),
        shared_{models_, cells_, options()},
        session_(shared_, *this, 0) {
    send(protocol::Hello{1, "bench"});
    send(protocol::Open{0, "model", false});
  }

  void wantWrite() override {}

  /// Bytes received, WebSocket headers included, seeds and base features apart, from a pose until
  /// its goal is reached.
  std::uint64_t look(protocol::Pose pose) {
    nowMs_ += 1000;  // after a rest
    pose.id = ++poseId_;
    const std::uint64_t before = received_;
    settled_ = false;
    send(pose);
    // Seeds come after what a pose needs, and are no concern here.
    for (int quiet = 0; quiet < 3 && !settled_; ++quiet) {
      const bool worked = tasks_.runAll();
      session_.update(nowMs_);
      if (take() || worked) quiet = 0;
      send(protocol::Acknowledge{payload_});
    }
    if (!settled_) failed_ = true;
    return received_ - before;
  }

  [[nodiscard]] const StreamDecoder& decoder() const { return decoder_; }

  [[nodiscard]] bool failed() const { return failed_; }

 private:
  static SessionOptions options() {
    SessionOptions options;
    options.prefetchAfterMs = -1;
    return options;
  }

  void send(const protocol::Body& body) { session_.receive(protocol::encodeMessage(body), nowMs_); }

  bool take() {
    bool any = false;
    while (!settled_) {
      const auto out = session_.nextMessage(nowMs_);
      if (!out) break;
      any = true;
      const std::size_t size = out->bytes().size();
      if (out->payload) payload_ += size;
      const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
      if (!message) {
        failed_ = true;
        return false;
      }
      std::uint64_t counted = size + (size < 126 ? 2 : size < 65536 ? 4 : 10);  // [RFC 6455, 5.2]
      const auto ok = std::visit(
          [&](const auto& body) -> Result<void> {
            using Body = std::decay_t<decltype(body)>;
            if constexpr (std::is_same_v<Body, protocol::ModelInfo>) {
              return decoder_.beginModel(body);
            } else if constexpr (std::is_same_v<Body, protocol::Seeds>) {
              counted = 0;
            } else if constexpr (std::is_same_v<Body, protocol::Base>) {
              counted -= body.features.size();
              return decoder_.take(body);
            } else if constexpr (std::is_same_v<Body, protocol::Settled>) {
              settled_ = body.pose == poseId_;
            } else if constexpr (requires { decoder_.take(body); }) {
              return decoder_.take(body);
            }
            return {};
          },
          message->body);
      if (!ok) failed_ = true;
      received_ += counted;
    }
    return any;
  }

  TimedTasks& tasks_;
  OneModel models_;
  ViewCells cells_;
  SessionShared shared_;
  Session session_;
  StreamDecoder decoder_;
  std::int64_t nowMs_ = 0;
  std::uint32_t poseId_ = 0;
  std::uint64_t payload_ = 0;
  std::uint64_t received_ = 0;
  bool settled_ = false;
  bool failed_ = false;
};

/// 95th percentile, by length, of the distance from the points of one contour to another, and
/// maximum.
std::pair<double, double> oneWay(
    std::span<const ContourPoint> from,
    std::span<const ContourPoint> to,
    const PictureView& picture) {
  std::vector<glm::vec2> pixels;
  for (const ContourPoint& p : to)
    pixels.push_back(p.px);
  const PixelPoints points(pixels, picture.width, picture.height, 100.0);
  std::vector<std::pair<double, double>> off;  // distance, length
  double sum = 0.0;
  for (const ContourPoint& p : from) {
    off.emplace_back(points.distanceTo(p.px), p.lengthPx);
    sum += p.lengthPx;
  }
  if (off.empty()) return {0.0, 0.0};
  std::ranges::sort(off);
  double passed = 0.0;
  for (const auto& [distance, length] : off) {
    passed += length;
    if (passed >= 0.95 * sum) return {distance, off.back().first};
  }
  return {off.back().first, off.back().first};
}

struct Sums {
  std::vector<double> values;

  void add(double value) { values.push_back(value); }

  [[nodiscard]] nlohmann::json json() const {
    double sum = 0.0;
    double most = 0.0;
    for (const double v : values) {
      sum += v;
      most = std::max(most, v);
    }
    return {
        {"mean", values.empty() ? 0.0 : sum / static_cast<double>(values.size())},
        {"max", most}};
  }
};

struct Bench {
  std::shared_ptr<const Model> model;
  int views = 20;

  /// Directions spread evenly over the sphere, in degrees.
  [[nodiscard]] protocol::Pose poseOf(int view, double turnDegrees = 0.0) const {
    const double azimuth = std::fmod(137.50776405 * view, 360.0) + turnDegrees;
    const double elevation = std::asin(2.0 * (view + 0.5) / views - 1.0) * 180.0 / std::numbers::pi;
    const BoundingSphere sphere{model->info().center, model->info().radius};
    const Camera camera = orbitCamera(sphere, azimuth, elevation);
    protocol::Pose pose;
    pose.eye = camera.eye;
    pose.forward = camera.forward();
    pose.up = camera.up;
    pose.fovY = static_cast<float>(camera.fovDegrees * std::numbers::pi / 180.0);
    return pose;
  }

  [[nodiscard]] std::pair<double, double> offOf(const Client& client, const protocol::Pose& pose)
      const {
    const ContourView view = contourViewOf(pose, model->forest().grid);
    const ActiveMesh& mesh = client.decoder().mesh();
    const SilhouetteField field(mesh.mesh(), mesh.positions(), view.kind);
    VisibleContourFinder finder;
    const auto full = finder.find(model->fullMesh()->field(view.kind), view.picture);
    const auto mine = finder.find(field, view.picture);
    const auto there = oneWay(full, mine, view.picture);
    const auto back = oneWay(mine, full, view.picture);
    return {std::max(there.first, back.first), std::max(there.second, back.second)};
  }

  [[nodiscard]] nlohmann::json settled(protocol::Silhouette kind, bool& failed) const {
    Sums bytes, p95, most, searchMs, faces;
    for (int view = 0; view < views; ++view) {
      TimedTasks tasks;
      Client client(model, tasks);
      protocol::Pose pose = poseOf(view);
      pose.silhouette = kind;
      bytes.add(static_cast<double>(client.look(pose)));
      searchMs.add(tasks.takeLongestMs());
      const auto off = offOf(client, pose);
      p95.add(off.first);
      most.add(off.second);
      faces.add(client.decoder().mesh().mesh().faceCount());
      failed = failed || client.failed();
    }
    return {
        {"bytes", bytes.json()},
        {"p95_px", p95.json()},
        {"max_px", most.json()},
        {"search_cpu_ms", searchMs.json()},
        {"faces", faces.json()}};
  }

  [[nodiscard]] nlohmann::json exact(protocol::Silhouette kind, bool& failed) const {
    constexpr int kTurns = 3;
    constexpr double kTurnDegrees = 5.0;
    Sums bytes, turn, chooseMs;
    for (int view = 0; view < views; ++view) {
      TimedTasks tasks;
      Client client(model, tasks);
      protocol::Pose pose = poseOf(view);
      pose.silhouette = kind;
      pose.goal = Goal::kExact;
      const auto cold = static_cast<double>(client.look(pose));
      bytes.add(cold);
      chooseMs.add(tasks.takeLongestMs());
      for (int step = 1; step <= kTurns; ++step) {
        protocol::Pose next = poseOf(view, kTurnDegrees * step);
        next.silhouette = kind;
        next.goal = Goal::kExact;
        turn.add(static_cast<double>(client.look(next)) / cold);
      }
      failed = failed || client.failed();
    }
    return {
        {"bytes", bytes.json()},
        {"turn_share", turn.json()},
        {"choose_cpu_ms", chooseMs.json()}};
  }

  /// What a view cell's target set takes.
  [[nodiscard]] nlohmann::json cell() const {
    Sums ms;
    for (int view = 0; view < views; ++view) {
      TimedTasks tasks;
      ViewCells cells(tasks, {});
      const auto ticket = cells.cell(model, viewCellOf(poseOf(view), model->info()));
      tasks.runAll();
      ms.add(tasks.takeLongestMs());
    }
    return {{"choose_cpu_ms", ms.json()}};
  }
};

int run(int argc, char** argv) {
  CLI::App app("Bytes until settled and exact, of sessions without a socket, as JSON");
  std::string store;
  std::string name;
  std::string kinds = "edges,smooth";
  bool noExact = false;
  Bench bench;
  app.add_option("STORE", store, "Folder of prepared models")->required();
  app.add_option("MODEL", name, "Name of a model there")->required();
  app.add_option("--views", bench.views, "Views at 3 radii, evenly spread")
      ->check(CLI::Range(1, 1000));
  app.add_option("--kinds", kinds, "edges, smooth or both");
  app.add_flag("--no-exact", noExact, "Settled only");
  CLI11_PARSE(app, argc, argv);
  const auto opened = openDirectoryStore(store);
  if (!opened) return std::fprintf(stderr, "%s\n", opened.error().message.c_str()), 1;
  const auto names = (*opened)->names();
  for (const NameRecord& record : names ? *names : std::vector<NameRecord>{}) {
    if (record.name != name) continue;
    const auto asset = (*opened)->open(record.asset);
    const auto model = asset ? Model::load(*asset) : tl::unexpected(asset.error());
    if (!model) return std::fprintf(stderr, "%s\n", model.error().message.c_str()), 1;
    bench.model = *model;
  }
  if (!bench.model) return std::fprintf(stderr, "%s: no such model\n", name.c_str()), 1;
  if (bench.model->fullMesh() == nullptr) return 1;
  bool failed = false;
  nlohmann::json out{{"model", name}, {"views", bench.views}, {"cell", bench.cell()}};
  for (const auto& [kind, kindName] :
       {std::pair{protocol::Silhouette::kEdges, "edges"},
        std::pair{protocol::Silhouette::kSmooth, "smooth"}}) {
    if (kinds.find(kindName) == std::string::npos) continue;
    out["settled"][kindName] = bench.settled(kind, failed);
    if (!noExact) out["exact"][kindName] = bench.exact(kind, failed);
  }
  std::printf("%s\n", out.dump().c_str());
  if (failed) std::fprintf(stderr, "%s: a session did not reach its goal\n", name.c_str());
  return failed ? 1 : 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
