// SPDX-License-Identifier: Apache-2.0
#include "client/net/cache_directory.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace limn {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

class CacheDirectory : public ::testing::Test {
 protected:
  CacheDirectory() { fs::remove_all(folder_); }

  ~CacheDirectory() override { fs::remove_all(folder_); }

  /// Keeps as many bytes under a hash made of `mark`, as if that long ago.
  void keep(SectionCache& cache, std::uint8_t mark, std::size_t bytes, int minutesAgo) const {
    cache.keep(hashOf(mark), Bytes(bytes, mark));
    const auto path = folder_ / (protocol::toHex(hashOf(mark)) + ".limn");
    if (fs::exists(path))
      fs::last_write_time(
          path,
          fs::file_time_type::clock::now() - std::chrono::minutes(minutesAgo));
  }

  static protocol::SectionHash hashOf(std::uint8_t mark) { return protocol::SectionHash{mark}; }

  const fs::path folder_ =
      fs::temp_directory_path() /
      ("limn-cache-test-" +
       std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(CacheDirectory, GivesBackWhatItWasGivenAlsoToALaterOne) {
  const auto cache = openCacheDirectory({.path = folder_ / "deep" / "down"});
  EXPECT_TRUE(cache->load(hashOf(1)).empty());
  cache->keep(hashOf(1), Bytes{5, 6, 7});
  EXPECT_EQ(cache->load(hashOf(1)), (Bytes{5, 6, 7}));
  EXPECT_TRUE(cache->load(hashOf(2)).empty());
  EXPECT_EQ(
      openCacheDirectory({.path = folder_ / "deep" / "down"})->load(hashOf(1)),
      (Bytes{5, 6, 7}));
  int files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_ / "deep" / "down"))
    ++files;
  EXPECT_EQ(files, 1);  // nothing half-written is left
}

TEST_F(CacheDirectory, WhatWasNotUsedLongestGoesFirst) {
  const auto cache = openCacheDirectory({.path = folder_, .maxBytes = 1000});
  keep(*cache, 1, 400, 30);
  keep(*cache, 2, 400, 20);
  EXPECT_FALSE(cache->load(hashOf(1)).empty());  // used now
  keep(*cache, 3, 400, 0);
  EXPECT_FALSE(cache->load(hashOf(1)).empty());
  EXPECT_TRUE(cache->load(hashOf(2)).empty());
  EXPECT_FALSE(cache->load(hashOf(3)).empty());
  keep(*cache, 4, 2000, 0);
  EXPECT_TRUE(cache->load(hashOf(4)).empty());
  EXPECT_FALSE(cache->load(hashOf(3)).empty());
}

TEST_F(CacheDirectory, LeavesFilesAloneThatAreNotItsOwn) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "letter.txt") << std::string(5000, 'x');
  std::ofstream(folder_ / "00.limn") << std::string(5000, 'x');
  // Of a writer that was killed: goes when room is needed.
  const fs::path part = folder_ / (std::string(32, 'a') + ".17-0.limn-part");
  std::ofstream(part) << std::string(900, 'x');
  fs::last_write_time(part, fs::file_time_type::clock::now() - std::chrono::hours(1));
  const auto cache = openCacheDirectory({.path = folder_, .maxBytes = 1000});
  keep(*cache, 1, 400, 0);
  EXPECT_FALSE(cache->load(hashOf(1)).empty());
  EXPECT_TRUE(fs::exists(folder_ / "letter.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "00.limn"));
  EXPECT_FALSE(fs::exists(part));
}

TEST_F(CacheDirectory, OneThatCannotBeWrittenKeepsNothing) {
  std::ofstream(folder_) << "a file where the folder should be";
  const auto cache = openCacheDirectory({.path = folder_});
  cache->keep(hashOf(1), Bytes{1});
  EXPECT_TRUE(cache->load(hashOf(1)).empty());
}

}  // namespace
}  // namespace limn
