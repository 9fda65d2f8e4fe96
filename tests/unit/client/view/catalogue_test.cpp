// SPDX-License-Identifier: Apache-2.0
#include "client/view/catalogue.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(Catalogue, ReadsWhatAServerLists) {
  const auto entries = parseCatalogue(R"([
    {"name":"bunny","state":"ready","progress":1,"faces":69630,"has_hull":true},
    {"name":"dragon","state":"preparing","progress":0.25},
    {"name":"broken","state":"failed","reason":"cut short"}])");
  ASSERT_TRUE(entries.has_value());
  ASSERT_EQ(entries->size(), 3U);
  EXPECT_EQ((*entries)[0].faces, 69630U);
  EXPECT_EQ((*entries)[1].state, CatalogueEntry::State::kPreparing);
  EXPECT_EQ((*entries)[1].progress, 0.25);
  EXPECT_EQ((*entries)[2].reason, "cut short");
}

TEST(Catalogue, LeavesOutWhatMakesNoSense) {
  const auto entries = parseCatalogue(
      R"([3, {"name":"../x","state":"ready"}, {"name":"a","state":"asleep"}, {"state":"ready"},
          {"name":"b","state":"ready","progress":"much","faces":"many"}])");
  ASSERT_TRUE(entries.has_value());
  ASSERT_EQ(entries->size(), 1U);
  EXPECT_EQ(entries->front().name, "b");
}

TEST(Catalogue, AnythingElseIsAnError) {
  for (const char* text : {"", "{}", "[", "<html>"})
    EXPECT_FALSE(parseCatalogue(text).has_value()) << text;
}

}  // namespace
}  // namespace limn
