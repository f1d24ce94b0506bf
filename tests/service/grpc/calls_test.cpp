// Each call of planemap.v1 over a real connection, beside what core's queries answer.

#include <cmath>
#include <planemap/query/snapshot_queries.hpp>

#include "codec/proto_codec.hpp"
#include "test_daemon.hpp"

namespace planemap::service {
namespace {

using grpc::StatusCode;

class Calls : public testing::Test {
 protected:
  void SetUp() override { daemon_.map_walls(6); }

  SnapshotQueries twin() { return SnapshotQueries(daemon_.service().snapshot(), Eigen::Vector3d::UnitZ()); }
  PlaneId plane_id() { return daemon_.service().snapshot()->planes().front()->id; }
  v1::NearestPlanesRequest nearest_request() {
    v1::NearestPlanesRequest request;
    v1::NearestPoint& point = *request.add_points();
    point.mutable_point_m()->set_z(0.75);
    point.set_sigma_m(0.01);
    return request;
  }
  void expect_is_newest(const v1::MapVersion& version) {
    const auto snapshot = daemon_.service().snapshot();
    EXPECT_EQ(version.epoch(), 1234u);
    EXPECT_EQ(version.revision(), snapshot->revision());
    EXPECT_EQ(version.utime(), snapshot->utime());
  }

  TestDaemon daemon_;
  std::unique_ptr<v1::PlaneMap::Stub> stub_ = daemon_.stub();
};

TEST_F(Calls, StatusTellsTheMapAndTheCounters) {
  v1::GetStatusResponse status;
  ASSERT_TRUE(stub_->GetStatus(new_context().get(), {}, &status).ok());
  expect_is_newest(status.map());
  EXPECT_EQ(status.plane_count(), daemon_.service().snapshot()->planes().size());
  EXPECT_EQ(status.counters().at("scans.mapped"), 6);
  EXPECT_FALSE(status.version().empty());
  EXPECT_FALSE(status.paused());
}

TEST_F(Calls, SnapshotBringsThePlanesWithTheirOutlines) {
  const auto [pages, status] = read_all(*stub_->GetSnapshot(new_context().get(), {}));
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(pages.size(), 1u);
  expect_is_newest(pages[0].map());
  EXPECT_TRUE(pages[0].last());
  EXPECT_EQ(pages[0].frame(), "world");
  const auto queries = twin();
  ASSERT_EQ(static_cast<std::size_t>(pages[0].planes_size()), queries.planes().size());
  ASSERT_GE(pages[0].planes_size(), 1);
  EXPECT_EQ(pages[0].plane_count(), queries.planes().size());
  const auto plane = from_proto(pages[0].planes(0));
  ASSERT_TRUE(plane) << plane.error().message;
  EXPECT_TRUE(plane->record.covariance.isApprox(queries.planes()[0].record->covariance, 1e-9));
  EXPECT_EQ(plane->plane_class, PlaneClass::kFloor);
  EXPECT_GT(plane->outline.area_m2, 0.3);
}

TEST_F(Calls, SnapshotObeysItsFilter) {
  v1::GetSnapshotRequest request;
  request.mutable_filter()->add_classes(v1::PLANE_CLASS_WALL);
  const auto [pages, status] = read_all(*stub_->GetSnapshot(new_context().get(), request));
  ASSERT_TRUE(status.ok());
  ASSERT_EQ(pages.size(), 1u);
  EXPECT_EQ(pages[0].planes_size(), 0);
}

TEST_F(Calls, NearestAgreesWithTheQuery) {
  v1::NearestPlanesResponse response;
  const auto status = stub_->NearestPlanes(new_context().get(), nearest_request(), &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  NearestQuery query;
  query.point_m = {0.0, 0.0, 0.75};
  query.covariance_m2 = 1e-4 * Eigen::Matrix3d::Identity();
  const auto queries = twin();
  const auto expected = queries.nearest(query);
  ASSERT_TRUE(expected);
  ASSERT_EQ(expected->size(), 1u);
  ASSERT_EQ(response.results_size(), 1);
  ASSERT_EQ(response.results(0).planes_size(), 1);
  const v1::NearPlane& near = response.results(0).planes(0);
  EXPECT_EQ(near.plane_id(), expected->front().id);
  EXPECT_EQ(near.signed_distance_m(), expected->front().signed_distance_m);
  EXPECT_NEAR(near.signed_distance_m(), 0.25, 0.02);
  EXPECT_EQ(near.sigma_m(), expected->front().sigma_m);
  EXPECT_EQ(near.mahalanobis(), expected->front().mahalanobis);
  EXPECT_TRUE(near.foot_inside());
  expect_is_newest(response.map());
}

TEST_F(Calls, RaysMeetPlaneAndCell) {
  v1::CastRaysRequest request;
  for (const double z : {1.0, -1.0}) request.add_rays()->mutable_direction()->set_z(z);
  v1::CastRaysResponse response;
  const auto status = stub_->CastRays(new_context().get(), request, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(response.hits_size(), 2);
  EXPECT_NEAR(response.hits(0).plane().range_m(), 1.0, 0.02);
  EXPECT_GT(response.hits(0).plane().sigma_m(), 0.0);
  EXPECT_NEAR(response.hits(0).cell().range_m(), 1.0, 0.05);
  EXPECT_GT(response.hits(0).cell().cell().count(), 0u);
  EXPECT_FALSE(response.hits(1).has_plane());
  EXPECT_FALSE(response.hits(1).has_cell());
}

TEST_F(Calls, RegionBringsPlanesPolygonsAndCells) {
  v1::QueryRegionRequest request;
  request.mutable_box()->mutable_min_m()->set_z(0.5);
  for (auto* corner : {request.mutable_box()->mutable_min_m(), request.mutable_box()->mutable_max_m()}) {
    corner->set_x(corner == request.mutable_box()->mutable_min_m() ? 0.0 : INFINITY);
  }
  request.mutable_box()->mutable_min_m()->set_y(-INFINITY);
  request.mutable_box()->mutable_max_m()->set_y(INFINITY);
  request.mutable_box()->mutable_max_m()->set_z(1.5);
  request.set_polygons(true);
  request.set_cells(true);
  const auto [pages, status] = read_all(*stub_->QueryRegion(new_context().get(), request));
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(pages.size(), 1u);
  RegionQuery query;
  query.region = BoxRegion{{0.0, -INFINITY, 0.5}, {INFINITY, INFINITY, 1.5}};
  query.polygons = query.cells = true;
  const auto expected = twin().region(query);
  ASSERT_TRUE(expected);
  ASSERT_EQ(static_cast<std::size_t>(pages[0].planes_size()), expected->planes.size());
  ASSERT_GE(pages[0].planes_size(), 1);
  EXPECT_EQ(pages[0].planes(0).area_m2(), expected->planes[0].area_m2);
  EXPECT_EQ(pages[0].planes(0).polygons_size(), 1);
  EXPECT_FALSE(pages[0].planes(0).whole());
  EXPECT_EQ(static_cast<std::size_t>(pages[0].cells_size()), expected->cells.size());
  EXPECT_GT(pages[0].cells_size(), 10);
}

TEST_F(Calls, CellsAreThoseOfTheSnapshot) {
  const auto [pages, status] = read_all(*stub_->GetCells(new_context().get(), {}));
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(pages.size(), 1u);
  std::size_t dense = 0;
  daemon_.service().snapshot()->for_each_cell([&](const CellView&) { ++dense; });
  EXPECT_EQ(static_cast<std::size_t>(pages[0].cells_size()), dense);
  v1::GetCellsRequest request;
  request.add_plane_ids(plane_id());
  const auto [own, own_status] = read_all(*stub_->GetCells(new_context().get(), request));
  ASSERT_TRUE(own_status.ok());
  ASSERT_GT(own.at(0).cells_size(), 10);
  for (const v1::Cell& cell : own[0].cells()) EXPECT_EQ(cell.plane_id(), plane_id());
}

TEST_F(Calls, PlaneTellsEverything) {
  v1::GetPlaneRequest request;
  request.set_plane_id(plane_id());
  v1::GetPlaneResponse response;
  const auto status = stub_->GetPlane(new_context().get(), request, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.fate(), v1::PLANE_FATE_LIVES);
  ASSERT_EQ(response.lineage_size(), 1);
  EXPECT_EQ(response.lineage(0), plane_id());
  EXPECT_EQ(response.plane().id(), plane_id());
  EXPECT_GT(response.normal_deviation_rad(), 0.0);
}

TEST_F(Calls, FloorPlanAgreesWithTheQuery) {
  v1::GetFloorPlanResponse response;
  const auto status = stub_->GetFloorPlan(new_context().get(), {}, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  const auto expected = twin().floorplan();
  ASSERT_TRUE(expected);
  EXPECT_EQ(response.free_area_m2(), expected->free_area_m2);
  EXPECT_GT(response.free_area_m2(), 0.3);
  ASSERT_GE(response.floor_size(), 1);
  EXPECT_NEAR(response.origin_m().z(), 1.0, 0.02);  // on the floor
}

TEST_F(Calls, BadArgumentsAreNamed) {
  const auto nearest_status = [&](const v1::NearestPlanesRequest& request) {
    v1::NearestPlanesResponse response;
    return stub_->NearestPlanes(new_context().get(), request, &response);
  };
  const auto bad = StatusCode::INVALID_ARGUMENT;
  expect_error(nearest_status({}), bad, "points: is missing");
  auto request = nearest_request();
  request.mutable_points(0)->mutable_point_m()->set_x(NAN);
  expect_error(nearest_status(request), bad, "points[0].point_m: not every coordinate is a finite number");
  request = nearest_request();
  request.add_points();
  expect_error(nearest_status(request), bad, "points[1].point_m: is missing");
  request = nearest_request();
  request.mutable_points(0)->add_covariance_m2(1.0);
  expect_error(nearest_status(request), bad, "points[0].covariance_m2: has 1 numbers, must have 6");
  for (int i = 0; i < 5; ++i) request.mutable_points(0)->add_covariance_m2(0.0);
  expect_error(nearest_status(request), bad, "points[0].sigma_m: give it or covariance_m2, not both");
  request = nearest_request();
  request.mutable_points(0)->set_sigma_m(-1.0);
  expect_error(nearest_status(request), bad, "points[0].sigma_m: must be finite and at least 0, is -1");
  request = nearest_request();
  request.set_count(5001);
  expect_error(nearest_status(request), bad, "points: 1 points with 5001 planes each are more than 5000 planes in all");
  request = nearest_request();
  request.set_max_distance_m(-1.0);
  expect_error(nearest_status(request), bad, "max_distance_m: must be at least 0, is -1");
  request = nearest_request();
  request.mutable_filter()->set_min_area_m2(-2.0);
  expect_error(nearest_status(request), bad, "filter.min_area_m2: must be finite and at least 0, is -2");
  request.mutable_filter()->add_classes(static_cast<v1::PlaneClass>(77));
  expect_error(nearest_status(request), bad, "filter.classes: 77 is no class");
}

TEST_F(Calls, BadRaysAreNamed) {
  const auto status_of = [&](const v1::CastRaysRequest& request) {
    v1::CastRaysResponse response;
    return stub_->CastRays(new_context().get(), request, &response);
  };
  const auto bad = StatusCode::INVALID_ARGUMENT;
  expect_error(status_of({}), bad, "rays: is missing");
  v1::CastRaysRequest request;
  request.add_rays();
  expect_error(status_of(request), bad, "direction");
  request.set_skip_cells(true);
  request.set_skip_planes(true);
  expect_error(status_of(request), bad, "skip_cells: with skip_planes nothing is left");
  for (int i = 0; i < 2000; ++i) request.add_rays();
  expect_error(status_of(request), bad, "rays: 2001 are more than 2000");
}

TEST_F(Calls, BadRegionsAreNamed) {
  const auto status_of = [&](const v1::QueryRegionRequest& request) {
    return read_all(*stub_->QueryRegion(new_context().get(), request)).second;
  };
  const auto bad = StatusCode::INVALID_ARGUMENT;
  v1::QueryRegionRequest request;
  expect_error(status_of(request), bad, "region: is missing");
  request.mutable_box();
  expect_error(status_of(request), bad, "box.min_m: is missing");
  request.mutable_sphere()->set_radius_m(-1.0);
  expect_error(status_of(request), bad, "radius_m");
  request.mutable_oriented_box();
  expect_error(status_of(request), bad, "oriented_box.pose: is missing");
  request.mutable_frustum()->mutable_pose()->set_rotation_w(0.5);
  expect_error(status_of(request), bad,
               "frustum.pose.rotation_w, _x, _y, _z: must be a unit quaternion, its length is 0.5");
  request.mutable_frustum()->mutable_pose()->set_rotation_w(1.0);
  request.mutable_frustum()->mutable_pose()->mutable_position_m()->set_x(1e12);
  expect_error(status_of(request), bad, "frustum.pose.position_m: coordinates may be at most ");
  request.mutable_cylinder()->set_radius_m(1.0);
  expect_error(status_of(request), bad, "cylinder.to_m: must not be the same point as from_m");
}

TEST_F(Calls, PlanesThatAreNotThereAreSaidSo) {
  v1::GetPlaneRequest request;
  v1::GetPlaneResponse response;
  expect_error(stub_->GetPlane(new_context().get(), request, &response), StatusCode::INVALID_ARGUMENT,
               "plane_id: must not be 0");
  request.set_plane_id(987654);
  expect_error(stub_->GetPlane(new_context().get(), request, &response), StatusCode::NOT_FOUND,
               "plane 987654 was never seen in the map of epoch 1234");
}

TEST_F(Calls, AnotherEpochIsRefusedEverywhere) {
  const auto code = StatusCode::FAILED_PRECONDITION;
  const std::string own = "epoch: the map is of epoch 1234, asked for is 9; its ids mean other planes";
  const std::string words = "filter." + own;
  v1::GetPlaneRequest plane;
  plane.set_plane_id(1);
  plane.set_epoch(9);
  v1::GetPlaneResponse plane_response;
  expect_error(stub_->GetPlane(new_context().get(), plane, &plane_response), code, own);
  auto nearest = nearest_request();
  nearest.mutable_filter()->set_epoch(9);
  v1::NearestPlanesResponse nearest_response;
  expect_error(stub_->NearestPlanes(new_context().get(), nearest, &nearest_response), code, words);
  v1::GetSnapshotRequest snapshot;
  snapshot.mutable_filter()->set_epoch(9);
  expect_error(read_all(*stub_->GetSnapshot(new_context().get(), snapshot)).second, code, words);
  v1::GetCellsRequest cells;
  cells.mutable_filter()->set_epoch(9);
  expect_error(read_all(*stub_->GetCells(new_context().get(), cells)).second, code, words);
}

TEST_F(Calls, ABatchInSeveralCallsIsAnsweredByOneMap) {
  auto request = nearest_request();
  request.set_more_follow(true);
  v1::NearestPlanesResponse first;
  ASSERT_TRUE(stub_->NearestPlanes(new_context().get(), request, &first).ok());
  request.set_more_follow(false);
  v1::CastRaysRequest rays;
  rays.set_more_follow(true);
  rays.add_rays()->mutable_direction()->set_z(1.0);
  v1::CastRaysResponse first_hits;
  ASSERT_TRUE(stub_->CastRays(new_context().get(), rays, &first_hits).ok());
  daemon_.map_walls(3, 1040);
  v1::NearestPlanesResponse newest;
  ASSERT_TRUE(stub_->NearestPlanes(new_context().get(), request, &newest).ok());
  EXPECT_GT(newest.map().revision(), first.map().revision());

  *request.mutable_map() = first.map();
  v1::NearestPlanesResponse more;
  auto status = stub_->NearestPlanes(new_context().get(), request, &more);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(more.SerializeAsString(), first.SerializeAsString());
  *rays.mutable_map() = first_hits.map();
  v1::CastRaysResponse more_hits;
  status = stub_->CastRays(new_context().get(), rays, &more_hits);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(more_hits.SerializeAsString(), first_hits.SerializeAsString());

  request.mutable_filter()->set_epoch(9);
  expect_error(stub_->NearestPlanes(new_context().get(), request, &more), StatusCode::INVALID_ARGUMENT,
               "filter.epoch: is 9, map.epoch is 1234");
  request.clear_filter();
  request.mutable_map()->set_revision(987654);
  expect_error(stub_->NearestPlanes(new_context().get(), request, &more), StatusCode::ABORTED,
               "map: epoch 1234 revision 987654 is not kept any more: ask all anew");
  EXPECT_EQ(daemon_.counter("grpc.calls.failed.aborted"), 1);
  v1::ResetResponse reset;
  ASSERT_TRUE(daemon_.admin()->Reset(new_context().get(), {}, &reset).ok());
  expect_error(stub_->CastRays(new_context().get(), rays, &more_hits), StatusCode::ABORTED, "ask all anew");
}

TEST_F(Calls, CellsOfTooManyPlanesAreRefused) {
  v1::GetCellsRequest request;
  for (PlaneId id = 1; id <= 10001; ++id) request.add_plane_ids(id);
  expect_error(read_all(*stub_->GetCells(new_context().get(), request)).second, StatusCode::INVALID_ARGUMENT,
               "plane_ids: 10001 are more than 10000");
}

TEST_F(Calls, FloorPlansNameWhatIsWrong) {
  v1::GetFloorPlanRequest request;
  request.set_wall_thickness_m(-1.0);
  v1::GetFloorPlanResponse response;
  expect_error(stub_->GetFloorPlan(new_context().get(), request, &response), StatusCode::INVALID_ARGUMENT,
               "wall_thickness_m");
  request.Clear();
  request.mutable_filter()->add_classes(v1::PLANE_CLASS_WALL);
  expect_error(stub_->GetFloorPlan(new_context().get(), request, &response), StatusCode::FAILED_PRECONDITION,
               "no floor was seen that passes the filter");
}

TEST(CallsWithoutGravity, ThereIsNoFloorPlan) {
  auto config = test_config();
  config.map.gravity.clear();
  TestDaemon daemon(config);
  v1::GetFloorPlanResponse response;
  expect_error(daemon.stub()->GetFloorPlan(new_context().get(), {}, &response), StatusCode::FAILED_PRECONDITION,
               "which way is down is not known (map.gravity)");
}

TEST_F(Calls, ADeadlineThatHasPassedAndACancelledCallAreObeyed) {
  auto context = new_context();
  context->set_deadline(std::chrono::system_clock::now() - std::chrono::seconds(1));
  v1::GetStatusResponse response;
  EXPECT_EQ(stub_->GetStatus(context.get(), {}, &response).error_code(), StatusCode::DEADLINE_EXCEEDED);
  // A stream that the client leaves is over on the server, too: its place is free again.
  auto cancelled = new_context();
  const auto reader = stub_->Watch(cancelled.get(), {});
  v1::WatchEvent event;
  ASSERT_TRUE(reader->Read(&event));
  cancelled->TryCancel();
  EXPECT_EQ(reader->Finish().error_code(), StatusCode::CANCELLED);
  EXPECT_TRUE(daemon_.handle_until([&] { return daemon_.counter("grpc.calls.failed.cancelled") >= 1; }));
}

}  // namespace
}  // namespace planemap::service
