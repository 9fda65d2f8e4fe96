// SPDX-License-Identifier: Apache-2.0
#include "server/store/directory_store.h"

#include "server/store/manifest.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>

namespace limn {
namespace {

namespace fs = std::filesystem;

/// A directory that is gone after the test.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (fs::temp_directory_path() / "limn-store-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }

  ~Scratch() {
    std::error_code error;
    fs::remove_all(path_, error);
  }

  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

using Bytes = std::vector<std::uint8_t>;

Bytes readFile(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void writeFile(const fs::path& file, const Bytes& bytes) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(
      reinterpret_cast<const char*>(bytes.data()),
      static_cast<std::streamsize>(bytes.size()));
}

const Sha256Digest kId = sha256(Bytes{1, 2, 3});
const Bytes kInfo{9, 8, 7, 6};
const Bytes kForest(1000, 0x5A);

Result<void> writeAsset(AssetStore& store, const Sha256Digest& id) {
  auto writer = store.create(id);
  if (!writer) return tl::unexpected(writer.error());
  for (const auto& [name, bytes] : {std::pair("info", &kInfo), std::pair("forest", &kForest)}) {
    if (auto added = (*writer)->addSection(name, *bytes); !added) return added;
  }
  if (auto added = (*writer)->addSection("empty", {}); !added) return added;
  return (*writer)->commit(R"({"name":"test"})");
}

bool holdsTheAsset(const AssetStore& store, const Sha256Digest& id) {
  const auto asset = store.open(id);
  return asset && (*asset)->id() == id && (*asset)->report() == R"({"name":"test"})" &&
         std::ranges::equal(*(*asset)->section("info"), kInfo) &&
         std::ranges::equal(*(*asset)->section("forest"), kForest) &&
         (*asset)->section("empty")->empty() && !(*asset)->section("absent");
}

std::size_t entries(const fs::path& directory) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
}

/// Does the first `steps` changes of the disk, then stops: the process dies, or every step fails.
/// The step that stops a write has written half.
class StoppingOps final : public FileOps {
 public:
  enum class Stop { kDie, kDiskFull };

  StoppingOps(int steps, Stop stop) : left_(steps), stop_(stop) {}

  Result<void> writeFile(const fs::path& file, std::span<const std::uint8_t> bytes) override {
    if (last()) {
      static_cast<void>(FileOps::writeFile(file, bytes.first(bytes.size() / 2)));
      return stopped();
    }
    return FileOps::writeFile(file, bytes);
  }

  Result<void> syncDirectory(const fs::path& directory) override {
    return last() ? stopped() : FileOps::syncDirectory(directory);
  }

  Result<void> rename(const fs::path& from, const fs::path& to) override {
    return last() ? stopped() : FileOps::rename(from, to);
  }

  Result<void> removeAll(const fs::path& path) override {
    return last() ? stopped() : FileOps::removeAll(path);
  }

  Result<void> makeDirectory(const fs::path& directory) override {
    return last() ? stopped() : FileOps::makeDirectory(directory);
  }

 private:
  bool last() { return left_-- <= 0; }

  Result<void> stopped() const {
    if (stop_ == Stop::kDie) ::_exit(77);
    return fail(ErrorCode::kIo, "no space left on device");
  }

  int left_;
  Stop stop_;
};

/// Runs `body` in a child process with a store that dies after `steps` steps. True when it died.
template <class Body>
bool diesAfter(const fs::path& root, int steps, Body body) {
  const pid_t child = ::fork();
  if (child == 0) {
    auto store =
        openDirectoryStore(root, std::make_shared<StoppingOps>(steps, StoppingOps::Stop::kDie));
    if (store) body(**store);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  return WEXITSTATUS(status) == 77;
}

TEST(DirectoryStore, GivesBackWhatWasCommitted) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path() / "deep" / "store");
  ASSERT_TRUE(store);
  EXPECT_FALSE((*store)->contains(kId));
  EXPECT_EQ((*store)->open(kId).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(writeAsset(**store, kId));
  EXPECT_TRUE((*store)->contains(kId));
  EXPECT_TRUE(holdsTheAsset(**store, kId));
  // Another process sees the same.
  EXPECT_TRUE(holdsTheAsset(**openDirectoryStore(scratch.path() / "deep" / "store"), kId));
}

TEST(DirectoryStore, ShowsNothingOfAnAssetBeforeItIsCommitted) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  {
    auto writer = (*store)->create(kId);
    ASSERT_TRUE((*writer)->addSection("info", kInfo));
    EXPECT_FALSE((*store)->contains(kId));
    EXPECT_EQ(entries(scratch.path() / "assets"), 0U);
  }
  EXPECT_EQ(entries(scratch.path() / "tmp"), 0U) << "a writer dropped without commit cleans up";
}

TEST(DirectoryStore, RefusesOddSectionNames) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  auto writer = (*store)->create(kId);
  for (const char* name : {"", "../x", "A", "a/b", "a.b"}) {
    EXPECT_FALSE((*writer)->addSection(name, kInfo)) << name;
  }
  EXPECT_TRUE((*writer)->addSection("info", kInfo));
  EXPECT_FALSE((*writer)->addSection("info", kInfo)) << "the same twice";
}

TEST(DirectoryStore, NoticesEveryTruncationAndFlippedByte) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  ASSERT_TRUE(writeAsset(**store, kId));
  const fs::path directory = scratch.path() / "assets" / toHex(kId);
  std::size_t checked = 0;
  for (const char* name : {"manifest.json", "manifest.sha256", "info.bin", "forest.bin"}) {
    const Bytes whole = readFile(directory / name);
    ASSERT_FALSE(whole.empty()) << name;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      Bytes damaged = whole;
      damaged[i] ^= static_cast<std::uint8_t>(1U << (i % 8));
      writeFile(directory / name, damaged);
      EXPECT_EQ((*store)->open(kId).error().code, ErrorCode::kCorrupt) << name << " byte " << i;
      writeFile(directory / name, Bytes(whole.begin(), whole.begin() + static_cast<long>(i)));
      EXPECT_EQ((*store)->open(kId).error().code, ErrorCode::kCorrupt) << name << " cut " << i;
      ++checked;
    }
    Bytes longer = whole;
    longer.push_back('\n');
    writeFile(directory / name, longer);
    EXPECT_EQ((*store)->open(kId).error().code, ErrorCode::kCorrupt) << name << " with a byte more";
    fs::remove(directory / name);
    EXPECT_EQ((*store)->open(kId).error().code, ErrorCode::kCorrupt) << name << " missing";
    writeFile(directory / name, whole);
  }
  EXPECT_GT(checked, 1000U);
  EXPECT_TRUE(holdsTheAsset(**store, kId)) << "put back, it is whole again";
}

TEST(DirectoryStore, CommitReplacesADamagedAssetAndKeepsAnIntactOne) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  ASSERT_TRUE(writeAsset(**store, kId));
  ASSERT_TRUE(writeAsset(**store, kId));
  EXPECT_EQ(entries(scratch.path() / "quarantine"), 0U);
  writeFile(scratch.path() / "assets" / toHex(kId) / "info.bin", {});
  ASSERT_TRUE(writeAsset(**store, kId));
  EXPECT_TRUE(holdsTheAsset(**store, kId));
  EXPECT_EQ(entries(scratch.path() / "quarantine"), 1U);
}

TEST(DirectoryStore, QuarantineMakesRoomAndKeepsOpenAssetsReadable) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  EXPECT_EQ((*store)->quarantine(kId).error().code, ErrorCode::kNotFound);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(writeAsset(**store, kId));
    const auto asset = (*store)->open(kId);
    ASSERT_TRUE((*store)->quarantine(kId));
    EXPECT_FALSE((*store)->contains(kId));
    EXPECT_TRUE(std::ranges::equal(*(*asset)->section("forest"), kForest));
  }
  EXPECT_EQ(entries(scratch.path() / "quarantine"), 3U);
}

TEST(DirectoryStore, DyingAtAnyStepLeavesNothingOrTheWholeAsset) {
  const Scratch scratch;
  bool died = true;
  int steps = 0;
  for (; died; ++steps) {
    const fs::path root = scratch.path() / std::to_string(steps);
    died = diesAfter(root, steps, [](AssetStore& store) {
      if (writeAsset(store, kId)) static_cast<void>(store.setName({"a", kId, "a.ply"}));
    });
    const auto store = openDirectoryStore(root);
    ASSERT_TRUE(store);
    EXPECT_EQ(entries(root / "tmp"), 0U) << "leftovers of step " << steps;
    if ((*store)->contains(kId)) {
      EXPECT_TRUE(holdsTheAsset(**store, kId)) << steps;
    }
    const auto names = (*store)->names();
    ASSERT_TRUE(names);
    EXPECT_TRUE((*store)->damagedNames()->empty());
    if (!names->empty()) {
      EXPECT_TRUE((*store)->contains(kId)) << "a name without its asset, step " << steps;
    }
    // Whatever was left, the work can be done again.
    ASSERT_TRUE(writeAsset(**store, kId));
    EXPECT_TRUE(holdsTheAsset(**store, kId));
  }
  EXPECT_GT(steps, 8) << "the writer takes more steps than that";
}

TEST(DirectoryStore, DyingWhileReplacingANameLeavesTheOldOrTheNew) {
  const Scratch scratch;
  const Sha256Digest other = sha256(Bytes{4});
  bool died = true;
  for (int steps = 0; died; ++steps) {
    const fs::path root = scratch.path() / std::to_string(steps);
    {
      const auto store = openDirectoryStore(root);
      ASSERT_TRUE(writeAsset(**store, kId));
      ASSERT_TRUE(writeAsset(**store, other));
      ASSERT_TRUE((*store)->setName({"a", kId, ""}));
    }
    died = diesAfter(root, steps, [&](AssetStore& store) {
      static_cast<void>(store.setName({"a", other, ""}));
    });
    const auto names = (*openDirectoryStore(root))->names();
    ASSERT_EQ(names->size(), 1U) << steps;
    EXPECT_TRUE((*names)[0].asset == kId || (*names)[0].asset == other);
    if (!died) {
      EXPECT_EQ((*names)[0].asset, other);
    }
  }
}

TEST(DirectoryStore, AFullDiskFailsTheWriteAndNothingElse) {
  const Scratch scratch;
  const Sha256Digest other = sha256(Bytes{4});
  bool failed = true;
  for (int steps = 0; failed; ++steps) {
    const fs::path root = scratch.path() / std::to_string(steps);
    ASSERT_TRUE(writeAsset(**openDirectoryStore(root), kId));
    {
      const auto store = openDirectoryStore(
          root,
          std::make_shared<StoppingOps>(steps, StoppingOps::Stop::kDiskFull));
      const auto written = writeAsset(**store, other);
      failed = !written;
      if (failed) {
        EXPECT_EQ(written.error().code, ErrorCode::kIo);
      }
      EXPECT_TRUE(holdsTheAsset(**store, kId));
    }
    const auto store = openDirectoryStore(root);
    EXPECT_EQ(entries(root / "tmp"), 0U);
    EXPECT_TRUE(!(*store)->contains(other) || holdsTheAsset(**store, other));
  }
}

TEST(DirectoryStore, LeavesTheWorkOfALiveWriterAlone) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  auto writer = (*store)->create(kId);
  ASSERT_TRUE((*writer)->addSection("info", kInfo));
  const pid_t child = ::fork();
  if (child == 0) {
    const auto second = openDirectoryStore(scratch.path());
    ::_exit(second ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  EXPECT_EQ(entries(scratch.path() / "tmp"), 1U);
  EXPECT_TRUE((*writer)->commit("{}"));
  EXPECT_TRUE((*store)->open(kId));
}

TEST(DirectoryStore, ConcurrentWritersOfOneAssetAllSucceed) {
  const Scratch scratch;
  constexpr int kWriters = 8;
  std::vector<std::thread> threads;
  std::vector<int> succeeded(kWriters, 0);
  for (int i = 0; i < kWriters; ++i) {
    threads.emplace_back([&, i] {
      const auto store = openDirectoryStore(scratch.path());
      succeeded[static_cast<std::size_t>(i)] = store && writeAsset(**store, kId) ? 1 : 0;
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(std::ranges::count(succeeded, 1), kWriters);
  const auto store = openDirectoryStore(scratch.path());
  EXPECT_TRUE(holdsTheAsset(**store, kId));
  EXPECT_EQ(entries(scratch.path() / "quarantine"), 0U);
  EXPECT_EQ(entries(scratch.path() / "tmp"), 0U);
}

TEST(DirectoryStore, KeepsNamesSortedWithTheirSources) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  ASSERT_TRUE(writeAsset(**store, kId));
  EXPECT_EQ((*store)->setName({"a", Sha256Digest{}, ""}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ((*store)->setName({"", kId, ""}).error().code, ErrorCode::kInvalidArgument);
  ASSERT_TRUE((*store)->setName({"z/../odd name", kId, "z.ply"}));
  ASSERT_TRUE((*store)->setName({"a", kId, "a.ply"}));
  auto names = (*store)->names();
  ASSERT_EQ(names->size(), 2U);
  EXPECT_EQ((*names)[0].name, "a");
  EXPECT_EQ((*names)[1].name, "z/../odd name");
  EXPECT_EQ((*names)[1].source, "z.ply");
  EXPECT_EQ((*store)->removeName("b").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE((*store)->removeName("z/../odd name"));
  EXPECT_EQ((*store)->names()->size(), 1U);
}

TEST(DirectoryStore, LeavesADamagedNameOutAndSaysSo) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  ASSERT_TRUE(writeAsset(**store, kId));
  ASSERT_TRUE((*store)->setName({"a", kId, ""}));
  ASSERT_TRUE((*store)->setName({"b", kId, ""}));
  Bytes text = readFile(scratch.path() / "names" / "a.json");
  text[text.size() / 2] ^= 4;
  writeFile(scratch.path() / "names" / "a.json", text);
  ASSERT_EQ((*store)->names()->size(), 1U);
  EXPECT_EQ((*store)->names()->front().name, "b");
  EXPECT_EQ(*(*store)->damagedNames(), std::vector<std::string>{"a.json"});
  ASSERT_TRUE((*store)->removeName("b"));
  EXPECT_EQ(*(*store)->removeUnreferenced(std::chrono::seconds(-1)), 0U)
      << "what a damaged name points at is unknown";
}

TEST(DirectoryStore, CollectsWhatNobodyNamesOnceItIsOld) {
  const Scratch scratch;
  const auto store = openDirectoryStore(scratch.path());
  const Sha256Digest other = sha256(Bytes{4});
  ASSERT_TRUE(writeAsset(**store, kId));
  ASSERT_TRUE(writeAsset(**store, other));
  ASSERT_TRUE((*store)->setName({"a", kId, ""}));
  EXPECT_EQ(*(*store)->removeUnreferenced(std::chrono::hours(1)), 0U) << "too young";
  EXPECT_EQ(*(*store)->removeUnreferenced(std::chrono::seconds(-1)), 1U);
  EXPECT_TRUE((*store)->contains(kId));
  EXPECT_FALSE((*store)->contains(other));
  EXPECT_EQ(entries(scratch.path() / "tmp"), 0U);
}

TEST(DirectoryStore, SaysWhenItCannotBeMade) {
  const Scratch scratch;
  writeFile(scratch.path() / "file", {1});
  const auto store = openDirectoryStore(scratch.path() / "file");
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace limn
