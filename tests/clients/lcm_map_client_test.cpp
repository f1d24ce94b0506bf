#include "planemap/client/lcm_map_client.hpp"

#include <gtest/gtest.h>

#include <set>

#include "fake_map_service.hpp"

namespace planemap::client {
namespace {

using planemap_lcm::reply_t;
using planemap_lcm::request_t;
using std::chrono::milliseconds;

constexpr milliseconds kLong(20000);  // never reached where an answer comes
constexpr milliseconds kShort(150);   // where none does

class LcmMapClientTest : public testing::Test {
 protected:
  LcmMapClientTest() { make_client(kLong); }

  void make_client(milliseconds ask_again_after) {
    LcmClientOptions options;
    options.ask_again_after = ask_again_after;
    options.lost_page_after = milliseconds(10);
    client_ = std::make_unique<LcmMapClient>(bus_, options);
  }

  /// Pages that were asked for again by number; on a busy machine more than once.
  std::set<int> pages_asked_again() const {
    std::set<int> pages;
    for (const request_t& request : service_.requests) {
      if (request.page >= 0) pages.insert(request.page);
    }
    return pages;
  }

  std::shared_ptr<lcm::LCM> bus_ = std::make_shared<lcm::LCM>("memq://");
  FakeMapService service_{bus_};
  std::unique_ptr<LcmMapClient> client_;
};

TEST_F(LcmMapClientTest, StatusArrivesWithItsCounters) {
  service_.answer = [&](const request_t& request) {
    reply_t reply = service_.page_of(request, 0, 1);
    planemap_lcm::status_t status{};
    status.version = "1.2.3";
    status.plane_count = 12;
    status.scan_rate_hz = 14.5;
    status.idle_reason = "no pose on POSE yet";
    planemap_lcm::counter_t counter{};
    counter.name = "scans.received";
    counter.value = 99;
    status.counters = {counter};
    status.n_counters = 1;
    reply.service_status = {status};
    reply.n_status = 1;
    service_.send(request, reply);
  };
  const auto status = client_->status(kLong);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(status->version, "1.2.3");
  EXPECT_EQ(status->plane_count, 12);
  EXPECT_EQ(status->scan_rate_hz, 14.5);
  EXPECT_EQ(status->idle_reason, "no pose on POSE yet");
  EXPECT_EQ(status->counters, (std::map<std::string, std::int64_t>{{"scans.received", 99}}));
  ASSERT_EQ(service_.requests.size(), 1u);
  EXPECT_EQ(service_.requests[0].operation, request_t::OPERATION_STATUS);
  EXPECT_EQ(service_.requests[0].reply_channel.rfind("PLANEMAP_REPLY_", 0), 0u);
  EXPECT_LE(service_.requests[0].reply_channel.size(), 63u);
}

TEST_F(LcmMapClientTest, APlaneArrivesWithAllItsNumbers) {
  service_.answer = [&](const request_t& request) { service_.send(request, service_.page_of(request, 0, 1)); };
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->frame, "world");
  EXPECT_EQ(map->epoch, 7);
  EXPECT_EQ(map->revision, 42);
  ASSERT_EQ(map->planes.size(), 1u);
  const Plane& plane = map->planes[0];
  EXPECT_EQ(plane.id, 100);
  EXPECT_EQ(plane.normal, (Vector3{0, 0, 1}));
  EXPECT_EQ(plane.d, -100.0);
  // Upper triangle 1..10 (x 1e-6), row by row: (0,0) 1, (0,3) 4, (1,1) 5, (2,3) 9, (3,3) 10.
  EXPECT_DOUBLE_EQ(plane.covariance[0], 1e-6);
  EXPECT_DOUBLE_EQ(plane.covariance[3], 4e-6);
  EXPECT_DOUBLE_EQ(plane.covariance[12], 4e-6);
  EXPECT_DOUBLE_EQ(plane.covariance[5], 5e-6);
  EXPECT_DOUBLE_EQ(plane.covariance[11], 9e-6);
  EXPECT_DOUBLE_EQ(plane.covariance[14], 9e-6);
  EXPECT_DOUBLE_EQ(plane.covariance[15], 1e-5);
  EXPECT_EQ(plane.cell_count, 140);
  EXPECT_EQ(plane.point_count, 100000);
  EXPECT_EQ(plane.plane_class, "table");
  ASSERT_EQ(plane.polygons.size(), 1u);
  EXPECT_EQ(plane.polygons[0].outer, (Ring{{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  ASSERT_EQ(plane.polygons[0].holes.size(), 1u);
  EXPECT_EQ(plane.polygons[0].holes[0], (Ring{{0.25, 0.25}, {0.25, 0.75}, {0.75, 0.75}, {0.75, 0.25}}));
}

TEST_F(LcmMapClientTest, PagesMayComeInAnyOrderAndTwice) {
  service_.answer = [&](const request_t& request) {
    for (const int page : {3, 1, 1, 0, 3, 2}) service_.send(request, service_.page_of(request, page, 4));
  };
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_EQ(map->planes.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(map->planes[i].id, 100 + static_cast<std::int64_t>(i));
}

TEST_F(LcmMapClientTest, LostPagesAreAskedForByNumber) {
  service_.answer = [&](const request_t& request) {
    for (int page = 0; page < 6; ++page) {
      const bool lost = request.page < 0 && (page == 1 || page == 4);
      if (!lost && (request.page < 0 || request.page == page))
        service_.send(request, service_.page_of(request, page, 6));
    }
  };
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->planes.size(), 6u);
  EXPECT_EQ(pages_asked_again(), (std::set<int>{1, 4}));
  for (const request_t& request : service_.requests) {
    EXPECT_EQ(request.request_id, service_.requests[0].request_id);
    EXPECT_EQ(request.epoch, request.page < 0 ? 0 : 7);
    EXPECT_EQ(request.revision, request.page < 0 ? 0 : 42);
  }
}

TEST_F(LcmMapClientTest, ALostRequestIsSentAgainUnderANewId) {
  make_client(milliseconds(50));
  service_.answer = [&](const request_t& request) {
    if (service_.requests.size() > 1) service_.send(request, service_.page_of(request, 0, 1));
  };
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_GE(service_.requests.size(), 2u);
  EXPECT_NE(service_.requests[0].request_id, service_.requests[1].request_id);
}

TEST_F(LcmMapClientTest, NobodyAnsweringIsUnreachable) {
  const auto status = client_->status(kShort);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, Error::Kind::kUnreachable);
  EXPECT_NE(status.error().message.find("PLANEMAP_REQUEST"), std::string::npos);
}

TEST_F(LcmMapClientTest, APageThatNeverComesMakesTheAnswerIncomplete) {
  service_.answer = [&](const request_t& request) {
    if (request.page < 0) service_.send(request, service_.page_of(request, 0, 3));
  };
  const auto map = client_->snapshot(kShort);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().kind, Error::Kind::kIncomplete);
  EXPECT_NE(map.error().message.find("1 of 3"), std::string::npos) << map.error().message;
}

TEST_F(LcmMapClientTest, AnErrorReplyIsTheError) {
  service_.answer = [&](const request_t& request) {
    service_.send_error(request, reply_t::STATUS_TOO_LARGE, "the map does not fit");
  };
  const auto map = client_->cells(kLong);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().kind, Error::Kind::kRefused);
  EXPECT_NE(map.error().message.find("the map does not fit"), std::string::npos);
}

TEST_F(LcmMapClientTest, AnAnswerThatIsGoneIsAskedForAnew) {
  service_.answer = [&](const request_t& request) {
    if (request.page >= 0) {
      service_.send_error(request, reply_t::STATUS_GONE, "revision 42 is not kept any more");
    } else if (service_.requests.size() == 1) {
      service_.send(request, service_.page_of(request, 1, 2));  // page 0 is lost
    } else {
      for (int page = 0; page < 2; ++page) service_.send(request, service_.page_of(request, page, 2));
    }
  };
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->planes.size(), 2u);
  EXPECT_GE(service_.requests.size(), 3u);
}

/// Answers with planes or cells, whichever is asked for, of a revision.
class WholeMapTest : public LcmMapClientTest {
 protected:
  void send_page(const request_t& request, std::int64_t revision) {
    reply_t reply = service_.page_of(request, 0, 1);
    reply.revision = revision;
    if (request.operation == request_t::OPERATION_CELLS) {
      reply.planes.clear();
      reply.n_planes = 0;
      planemap_lcm::cell_t cell{};
      cell.count = static_cast<std::int32_t>(revision);
      reply.cells = {cell};
      reply.n_cells = 1;
    }
    service_.send(request, reply);
  }
  std::vector<std::int64_t> cells_asked_for() const {
    std::vector<std::int64_t> revisions;
    for (const request_t& request : service_.requests) {
      if (request.operation == request_t::OPERATION_CELLS) revisions.push_back(request.revision);
    }
    return revisions;
  }
};

TEST_F(WholeMapTest, CellsAreAskedForOfThePlanesRevision) {
  service_.answer = [&](const request_t& request) {
    const bool newest = request.epoch == 0;  // the map goes on with each request
    send_page(request, newest ? 40 + static_cast<std::int64_t>(service_.requests.size()) : request.revision);
  };
  const auto map = client_->whole_map(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->revision, 41);
  EXPECT_EQ(map->planes.size(), 1u);
  ASSERT_EQ(map->cells.size(), 1u);
  EXPECT_EQ(map->cells[0].count, 41);
  ASSERT_EQ(service_.requests.size(), 2u);
  EXPECT_EQ(service_.requests[1].epoch, 7);
}

TEST_F(WholeMapTest, StartsOverWhereTheRevisionIsGone) {
  service_.answer = [&](const request_t& request) {
    if (request.operation == request_t::OPERATION_SNAPSHOT) {
      send_page(request, 40 + static_cast<std::int64_t>(service_.requests.size()));
    } else if (request.revision == 41) {
      service_.send_error(request, reply_t::STATUS_GONE, "not kept any more");
    } else {
      send_page(request, request.revision);
    }
  };
  const auto map = client_->whole_map(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->revision, 43);
  EXPECT_EQ(map->cells.at(0).count, 43);
  EXPECT_EQ(cells_asked_for(), (std::vector<std::int64_t>{41, 43}));
}

TEST_F(WholeMapTest, NeverMixesCellsOfAnotherRevision) {
  service_.answer = [&](const request_t& request) {  // pays no heed to the revision, and comes to rest at 45
    send_page(request, std::min<std::int64_t>(45, 40 + static_cast<std::int64_t>(service_.requests.size())));
  };
  const auto map = client_->whole_map(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->revision, 45);
  EXPECT_EQ(map->cells.at(0).count, 45);
}

TEST_F(WholeMapTest, AMapThatIsAlwaysGoneIsIncomplete) {
  service_.answer = [&](const request_t& request) {
    if (request.operation == request_t::OPERATION_SNAPSHOT) return send_page(request, 41);
    service_.send_error(request, reply_t::STATUS_GONE, "not kept any more");
  };
  const auto map = client_->whole_map(kShort);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().kind, Error::Kind::kIncomplete) << map.error().message;
}

TEST_F(WholeMapTest, PlanesWithoutCellsAreIncomplete) {
  service_.answer = [&](const request_t& request) {
    if (request.operation == request_t::OPERATION_SNAPSHOT) send_page(request, 41);
  };
  const auto map = client_->whole_map(kShort);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().kind, Error::Kind::kIncomplete);
  EXPECT_NE(map.error().message.find("the planes came, but no cells within 0.15 s"), std::string::npos)
      << map.error().message;
}

TEST_F(LcmMapClientTest, PagesOfTwoRevisionsAreNeverMixed) {
  service_.answer = [&](const request_t& request) {
    for (int page = 0; page < 2; ++page) {
      reply_t reply = service_.page_of(request, page, 2);
      if (service_.requests.size() == 1) reply.revision = 40 + page;
      service_.send(request, reply);
    }
  };
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->revision, 42);
  EXPECT_EQ(service_.requests.size(), 2u);
}

TEST_F(LcmMapClientTest, BytesThatAreNoReplyAndAnswersToOthersArePassedOver) {
  service_.answer = [&](const request_t& request) {
    const std::string noise = "not a reply";
    bus_->publish(request.reply_channel, noise.data(), static_cast<unsigned int>(noise.size()));
    request_t of_another = request;
    of_another.request_id += 1000;
    service_.send(request, service_.page_of(of_another, 0, 1));
    reply_t beyond = service_.page_of(request, 2, 2);
    service_.send(request, beyond);
    for (int page = 0; page < 2; ++page) service_.send(request, service_.page_of(request, page, 2));
  };
  const auto map = client_->snapshot(kLong);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->planes.size(), 2u);
  EXPECT_EQ(client_->malformed_count(), 2u);
}

TEST(LcmMapClientConnect, AnUrlThatLcmCannotOpenIsNoNetwork) {
  const auto client = LcmMapClient::connect("nonsense://");
  ASSERT_FALSE(client);
  EXPECT_EQ(client.error().kind, Error::Kind::kNoNetwork);
  EXPECT_NE(client.error().message.find("nonsense://"), std::string::npos);
}

}  // namespace
}  // namespace planemap::client
