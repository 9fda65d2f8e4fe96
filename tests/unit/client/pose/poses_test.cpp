// SPDX-License-Identifier: Apache-2.0
#include "client/pose/camera_file.h"
#include "client/pose/orbit.h"
#include "client/pose/orbit_path.h"
#include "client/pose/path_recorder.h"
#include "client/pose/recorded_path.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(Orbit, ReadsTwoOrThreeNumbers) {
  const auto two = parseOrbit("orbit:30,-20.5");
  ASSERT_TRUE(two);
  EXPECT_EQ(two->azimuthDegrees, 30.0);
  EXPECT_EQ(two->elevationDegrees, -20.5);
  EXPECT_EQ(two->distanceRadii, 3.0);
  EXPECT_EQ(parseOrbit("orbit:0,90,0.6")->distanceRadii, 0.6);
}

TEST(Orbit, RefusesEverythingElseWithAnExample) {
  for (const char* text :
       {"",
        "30,20",
        "orbit:",
        "orbit:30",
        "orbit:30,",
        "orbit:,20",
        "orbit:a,b",
        "orbit:30,20,3,4",
        "orbit:30,91",
        "orbit:30,20,0",
        "orbit:30,20,-1",
        "orbit:nan,0",
        "orbit:inf,0",
        "orbit:30 ,20",
        "orbit:1e999,0"}) {
    const auto orbit = parseOrbit(text);
    ASSERT_FALSE(orbit) << text;
    EXPECT_NE(orbit.error().message.find("orbit:30,20,3"), std::string::npos);
  }
}

TEST(CameraFile, ReadsEveryField) {
  const auto camera =
      parseCamera(R"({"eye":[1,2,3],"target":[0,0.5,0],"up":[0,0,1],"fov":55,"ortho":true})");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->eye, glm::dvec3(1.0, 2.0, 3.0));
  EXPECT_EQ(camera->target, glm::dvec3(0.0, 0.5, 0.0));
  EXPECT_EQ(camera->up, glm::dvec3(0.0, 0.0, 1.0));
  EXPECT_EQ(camera->fovDegrees, 55.0);
  EXPECT_TRUE(camera->orthographic);
  const auto least = parseCamera(R"({"eye":[0,0,3],"target":[0,0,0]})");
  ASSERT_TRUE(least);
  EXPECT_EQ(least->up, glm::dvec3(0.0, 1.0, 0.0));
  EXPECT_EQ(least->fovDegrees, 40.0);
}

TEST(CameraFile, RefusesWhatIsNoCamera) {
  for (const char* text :
       {"",
        "[]",
        "{",
        R"({"eye":[0,0,3]})",
        R"({"eye":[0,0],"target":[0,0,0]})",
        R"({"eye":"x","target":[0,0,0]})",
        R"({"eye":[0,0,null],"target":[0,0,0]})",
        R"({"eye":[0,0,0],"target":[0,0,0]})",
        R"({"eye":[0,3,0],"target":[0,0,0]})",
        R"({"eye":[0,0,3],"target":[0,0,0],"up":[0,0,0]})",
        R"({"eye":[0,0,3],"target":[0,0,0],"fov":0})",
        R"({"eye":[0,0,3],"target":[0,0,0],"fov":"wide"})",
        R"({"eye":[0,0,3],"target":[0,0,0],"ortho":1})",
        R"({"eye":[0,0,1e999],"target":[0,0,0]})"}) {
    EXPECT_FALSE(parseCamera(text)) << text;
  }
  EXPECT_EQ(readCameraFile("/nonexistent/camera.json").error().code, ErrorCode::kNotFound);
}

TEST(OrbitPath, GoesOnceAroundAndFitsTheModel) {
  const BoundingSphere model{{1.0, 2.0, 3.0}, 2.0};
  const CameraPath path = orbitPath(model, {0.0, 0.0, 3.0}, 40.0, 4);
  ASSERT_EQ(path.size(), 4U);
  const glm::dvec3 expected[] = {
      {1.0, 2.0, 9.0},
      {7.0, 2.0, 3.0},
      {1.0, 2.0, -3.0},
      {-5.0, 2.0, 3.0}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(glm::distance(path[i].eye, expected[i]), 1e-9) << i;
    EXPECT_LE(path[i].nearPlane, 4.0);
    EXPECT_GE(path[i].farPlane, 8.0);
  }
}

TEST(CameraFile, ComesBackAsItWasWritten) {
  Camera camera = orbitCamera({{0.1, -2.0, 3.7}, 1.3}, 33.3, -71.0, 2.2, 27.5);
  camera.orthographic = true;
  const auto back = parseCamera(cameraFileJson(camera));
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(back->eye, camera.eye);
  EXPECT_EQ(back->target, camera.target);
  EXPECT_EQ(back->up, camera.up);
  EXPECT_EQ(back->fovDegrees, camera.fovDegrees);
  EXPECT_TRUE(back->orthographic);
}

Camera at(double x) {
  Camera camera;
  camera.eye = {x, 0.0, 3.0};
  camera.fovDegrees = 50.0;
  return camera;
}

TEST(RecordedPath, ComesBackFromItsFile) {
  const RecordedPath path = {{0.0, at(0.0)}, {0.25, at(1.0)}, {2.0, at(-1.5)}};
  const auto back = parseRecordedPath(recordedPathJson(path));
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->size(), 3U);
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ((*back)[i].seconds, path[i].seconds);
    EXPECT_EQ((*back)[i].camera.eye, path[i].camera.eye);
    EXPECT_EQ((*back)[i].camera.fovDegrees, 50.0);
  }
}

TEST(RecordedPath, RunsStraightBetweenMomentsAndStandsAtItsEnds) {
  const RecordedPath path = {{5.0, at(0.0)}, {6.0, at(1.0)}, {8.0, at(5.0)}};
  EXPECT_EQ(durationOf(path), 3.0);
  EXPECT_EQ(cameraAt(path, -1.0).eye.x, 0.0);
  EXPECT_EQ(cameraAt(path, 0.5).eye.x, 0.5);
  EXPECT_EQ(cameraAt(path, 2.0).eye.x, 3.0);
  EXPECT_EQ(cameraAt(path, 3.0).eye.x, 5.0);
  EXPECT_EQ(cameraAt(path, 9.0).eye.x, 5.0);
}

TEST(RecordedPath, WithoutTimesGoesATenthOfASecondEach) {
  const auto path =
      parseRecordedPath(R"([{"eye":[0,0,3],"target":[0,0,0]},{"eye":[1,0,3],"target":[0,0,0]}])");
  ASSERT_TRUE(path);
  EXPECT_EQ(durationOf(*path), 0.1);
  EXPECT_EQ(parseRecordedPath(R"({"eye":[0,0,3],"target":[0,0,0]})")->size(), 1U);
}

TEST(RecordedPath, RefusesWhatIsNoneAndSaysWhere) {
  for (const char* text :
       {"",
        "[]",
        "3",
        "[3]",
        R"([{"eye":[0,0,3]}])",
        R"([{"t":"x","eye":[0,0,3],"target":[0,0,0]}])",
        R"([{"t":1,"eye":[0,0,3],"target":[0,0,0]},{"t":1,"eye":[0,1,3],"target":[0,0,0]}])"}) {
    const auto path = parseRecordedPath(text);
    ASSERT_FALSE(path) << text;
    EXPECT_NE(path.error().message.find("entry"), std::string::npos);
  }
  EXPECT_EQ(readRecordedPath("/nonexistent/path.json").error().code, ErrorCode::kNotFound);
}

TEST(PathRecorder, KeepsHowLongTheCameraStood) {
  PathRecorder recorder;
  EXPECT_TRUE(recorder.path().empty());
  for (const double seconds : {10.0, 10.5, 11.0})
    recorder.add(seconds, at(0.0));
  recorder.add(11.1, at(1.0));
  recorder.add(12.0, at(1.0));
  const RecordedPath path = recorder.path();
  ASSERT_EQ(path.size(), 4U);
  EXPECT_EQ(durationOf(path), 2.0);
  EXPECT_EQ(cameraAt(path, 0.9).eye.x, 0.0) << "it stood";
  EXPECT_NEAR(cameraAt(path, 1.05).eye.x, 0.5, 1e-9);
  EXPECT_EQ(cameraAt(path, 2.0).eye.x, 1.0);
}

}  // namespace
}  // namespace limn
