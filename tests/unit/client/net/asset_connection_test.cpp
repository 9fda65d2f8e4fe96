// SPDX-License-Identifier: Apache-2.0
#include "client/net/asset_connection.h"

#include "client/core/client_session.h"
#include "client/net/asset_files.h"
#include "server/store/asset_store.h"
#include "tests/unit/client/core/small_asset.h"

#include "protocol/framing.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace limn {
namespace {

namespace fs = std::filesystem;

const SmallAsset& knot() {
  static const SmallAsset asset = makeSmallAsset(primitives::torusKnot(2, 3, 80, 8));
  return asset;
}

/// A store with the knot in it, written by the server's own code.
class AssetFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() /
            ("limn-asset-test-" + std::to_string(::getpid()) + "-" +
             ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(root_);
    auto store = openDirectoryStore(root_);
    ASSERT_TRUE(store) << store.error().message;
    auto writer = (*store)->create(knot().id);
    ASSERT_TRUE(writer) << writer.error().message;
    const auto add = [&](const char* name, const std::vector<std::vector<std::uint8_t>>& messages) {
      std::vector<std::uint8_t> section;
      for (const auto& message : messages)
        protocol::appendFrame(section, message);
      ASSERT_TRUE((*writer)->addSection(name, section));
    };
    add(sections::kInfo, {knot().info});
    add(sections::kBase, {knot().base});
    add(sections::kBlocks, knot().blocks);
    add(sections::kPackets, knot().packets);
    ASSERT_TRUE(
        (*writer)->commit(R"({"name":"trefoil","asset_format":)" + std::to_string(format()) + "}"));
    directory_ = root_ / "assets" / toHex(knot().id);
  }

  [[nodiscard]] virtual int format() const { return protocol::kAssetFormat; }

  void TearDown() override { fs::remove_all(root_); }

  fs::path root_;
  fs::path directory_;
};

TEST_F(AssetFilesTest, PlayTheWholePreparedMesh) {
  auto files = readAssetFiles(directory_);
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_EQ(files->name, "trefoil");
  const auto shared = std::make_shared<const AssetFiles>(std::move(*files));
  ClientSession::Options options;
  options.session.model = shared->name;
  options.session.stop.state = MeshState::kComplete;
  ClientSession session([shared] { return makeAssetConnection(shared); }, options);
  const auto outcome = session.waitUntilDone(20'000);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(isWhole(knot(), outcome->snapshot->mesh));
}

TEST_F(AssetFilesTest, AFlippedByteInAnyFileIsNoticed) {
  for (const auto& entry : fs::directory_iterator(directory_)) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string good{std::istreambuf_iterator<char>(in), {}};
    in.close();
    for (std::size_t at = 0; at < good.size(); at += std::max<std::size_t>(1, good.size() / 12)) {
      std::string bad = good;
      bad[at] = static_cast<char>(bad[at] ^ 0x20);
      std::ofstream(entry.path(), std::ios::binary) << bad;
      EXPECT_FALSE(readAssetFiles(directory_)) << entry.path() << " at " << at;
    }
    std::ofstream(entry.path(), std::ios::binary) << good;
  }
  EXPECT_TRUE(readAssetFiles(directory_));
}

TEST_F(AssetFilesTest, AMissingOrCutFileIsNoticed) {
  for (const char* name :
       {"base.bin", "packets.bin", "info.bin", "manifest.json", "manifest.sha256"}) {
    const fs::path path = directory_ / name;
    const fs::path aside = root_ / "aside";
    fs::rename(path, aside);
    EXPECT_FALSE(readAssetFiles(directory_)) << name;
    fs::copy_file(aside, path);
    fs::resize_file(path, fs::file_size(path) / 2);
    EXPECT_FALSE(readAssetFiles(directory_)) << name;
    fs::remove(path);
    fs::rename(aside, path);
  }
  EXPECT_TRUE(readAssetFiles(directory_));
}

/// Written by a Limn of before.
class OlderAssetFilesTest : public AssetFilesTest {
  [[nodiscard]] int format() const override { return protocol::kAssetFormat - 1; }
};

TEST_F(OlderAssetFilesTest, AreRefusedByTheirVersion) {
  const auto files = readAssetFiles(directory_);
  ASSERT_FALSE(files);
  EXPECT_EQ(files.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(files.error().message.find("older Limn"), std::string::npos) << files.error().message;
  EXPECT_NE(files.error().message.find("limn-prepare"), std::string::npos);
}

TEST_F(AssetFilesTest, APlaceWithoutAnAssetIsNamed) {
  const auto files = readAssetFiles(root_);
  ASSERT_FALSE(files);
  EXPECT_EQ(files.error().code, ErrorCode::kNotFound);
  EXPECT_NE(files.error().message.find(root_.string()), std::string::npos);
}

}  // namespace
}  // namespace limn
