// What requests over LCM are answered with.
#include <gtest/gtest.h>

#include <algorithm>

#include "lcm/request_answerer_fixture.hpp"

namespace planemap::service {
namespace {

using planemap_lcm::reply_t;
using planemap_lcm::request_t;

TEST_F(RequestAnswererTest, SnapshotHoldsAllPlanes) {
  const auto snapshot = walls_.snapshot();
  const auto reply = ask(request_for(request_t::OPERATION_SNAPSHOT), snapshot);
  EXPECT_EQ(reply.channel, "PLANEMAP_REPLY_A");
  const reply_t page = only_page(reply);
  EXPECT_EQ(page.status, reply_t::STATUS_OK);
  EXPECT_EQ(page.epoch, 9);
  EXPECT_EQ(page.revision, static_cast<std::int64_t>(snapshot->revision()));
  ASSERT_EQ(page.n_planes, 1);
  EXPECT_GE(page.planes[0].n_polygons, 1);
  EXPECT_EQ(page.n_cells, 0);
}

TEST_F(RequestAnswererTest, CellsComeInPagesAndEachCanBeAskedForAgain) {
  const auto snapshot = walls_.snapshot();
  std::size_t dense = 0;
  snapshot->for_each_cell([&](const CellView&) { ++dense; });
  ASSERT_GT(dense, 80u);
  const auto reply = ask(request_for(request_t::OPERATION_CELLS), snapshot);
  ASSERT_GE(reply.end, 2u);
  std::size_t cells = 0;
  for (const auto& page : decoded<reply_t>(*reply.pages)) cells += page.cells.size();
  EXPECT_EQ(cells, dense);
  auto again = request_for(request_t::OPERATION_CELLS);
  again.epoch = 9;
  again.revision = static_cast<std::int64_t>(snapshot->revision());
  again.page = 1;
  walls_.look_at(750, 1.5);  // the map goes on; the kept reply does not
  const auto lost = ask(again, walls_.snapshot());
  ASSERT_EQ(lost.begin, 1u);
  EXPECT_EQ(lost.end, 2u);
  EXPECT_EQ((*lost.pages)[1], (*reply.pages)[1]);
}

TEST_F(RequestAnswererTest, AnswersThatAreTooLargeAreRefusedWithWhatToAskInstead) {
  const auto snapshot = walls_.snapshot();
  const auto refusal_below = [&](std::size_t max_reply_bytes, const Request& request) {
    RequestAnswerer answerer(make_config(), book_, max_reply_bytes);
    const auto reply = answerer.answer(
        request, snapshot, [] { return planemap_lcm::status_t{}; }, 123);
    EXPECT_EQ(only_page(reply).status, reply_t::STATUS_TOO_LARGE);
    EXPECT_EQ(only_page(reply).n_cells, 0);
    return only_page(reply).error;
  };
  const std::string cells = std::to_string(snapshot->cell_count());
  const auto for_cells = request_for(request_t::OPERATION_CELLS);
  EXPECT_EQ(refusal_below(1000, for_cells),
            "the map's " + cells + " cells are more than 1000 bytes; ask for those of regions");
  const std::size_t just = 2 * snapshot->cell_count() * sizeof(planemap_lcm::cell_t);
  const auto pages = ask(for_cells, snapshot).end;
  EXPECT_EQ(refusal_below(4095, request_for(request_t::OPERATION_SNAPSHOT)),
            "the answer is 1 pages of 4096 bytes, more than 4095 bytes in all; ask for less at a time");
  RequestAnswerer enough(make_config(), book_, just);
  const auto reply = enough.answer(
      for_cells, snapshot, [] { return planemap_lcm::status_t{}; }, 123);
  EXPECT_EQ(reply.end, pages);
}

TEST_F(RequestAnswererTest, CellsCanBeHadOfTheRevisionOfThePlanes) {
  const auto snapshot = walls_.snapshot();
  ask(request_for(request_t::OPERATION_SNAPSHOT), snapshot);
  std::size_t dense = 0;
  snapshot->for_each_cell([&](const CellView&) { ++dense; });
  walls_.look_at(750, 1.5);  // the map goes on
  const auto newest = walls_.snapshot();
  ASSERT_GT(newest->revision(), snapshot->revision());
  const auto cells_of = [&](std::int64_t epoch, std::int64_t revision, const char* channel) {
    auto request = request_for(request_t::OPERATION_CELLS, channel);
    request.epoch = epoch;
    request.revision = revision;
    return decoded<reply_t>(*ask(request, newest).pages);
  };
  const auto revision = static_cast<std::int64_t>(snapshot->revision());
  for (const char* channel : {"PLANEMAP_REPLY_A", "PLANEMAP_REPLY_B"}) {  // who asked for the planes, and another
    std::size_t cells = 0;
    for (const auto& page : cells_of(9, revision, channel)) {
      EXPECT_EQ(page.status, reply_t::STATUS_OK) << page.error;
      EXPECT_EQ(page.epoch, 9);
      EXPECT_EQ(page.revision, revision);
      cells += page.cells.size();
    }
    EXPECT_EQ(cells, dense) << channel;
  }
  const auto newest_revision = static_cast<std::int64_t>(newest->revision());
  EXPECT_EQ(cells_of(9, newest_revision, "PLANEMAP_REPLY_A").at(0).revision, newest_revision);
  EXPECT_EQ(cells_of(0, 0, "PLANEMAP_REPLY_A").at(0).revision, newest_revision);
  for (const auto& [epoch, gone] : {std::pair<std::int64_t, std::int64_t>{9, 1000}, {8, newest_revision}}) {
    const auto pages = cells_of(epoch, gone, "PLANEMAP_REPLY_A");
    ASSERT_EQ(pages.size(), 1u);
    EXPECT_EQ(pages[0].status, reply_t::STATUS_GONE);
    EXPECT_NE(pages[0].error.find("is not kept any more: ask anew"), std::string::npos) << pages[0].error;
  }
}

TEST_F(RequestAnswererTest, CellsComeFromTheVerySnapshotOfThePlanes) {
  const auto snapshot = walls_.snapshot();
  ask(request_for(request_t::OPERATION_SNAPSHOT), snapshot);
  const auto twin = walls_.snapshot();  // of the same revision; it may hold more cells
  ASSERT_NE(twin, snapshot);
  ASSERT_EQ(twin->revision(), snapshot->revision());
  auto request = request_for(request_t::OPERATION_CELLS);
  request.epoch = 9;
  request.revision = static_cast<std::int64_t>(snapshot->revision());
  const auto reply = ask(request, twin);
  EXPECT_EQ(ask(request_for(request_t::OPERATION_CELLS, "PLANEMAP_REPLY_B"), snapshot).pages, reply.pages)
      << "made once for the snapshot, and kept";
}

TEST_F(RequestAnswererTest, StatusIsOnePage) {
  const reply_t page = only_page(ask(request_for(request_t::OPERATION_STATUS), walls_.snapshot()));
  EXPECT_EQ(page.status, reply_t::STATUS_OK);
  EXPECT_EQ(page.n_status, 1);
}
TEST_F(RequestAnswererTest, OldRepliesAreForgottenAndOthersStay) {
  const auto snapshot = walls_.snapshot();
  for (const char* channel : {"PLANEMAP_REPLY_A", "PLANEMAP_REPLY_B", "PLANEMAP_REPLY_C"}) {
    ask(request_for(request_t::OPERATION_SNAPSHOT, channel), snapshot);
  }
  const auto status_of_lost_page = [&](const char* channel) {
    auto request = request_for(request_t::OPERATION_SNAPSHOT, channel);
    request.page = 0;
    request.epoch = 9;
    request.revision = static_cast<std::int64_t>(snapshot->revision());
    return only_page(ask(request, snapshot)).status;
  };
  EXPECT_EQ(status_of_lost_page("PLANEMAP_REPLY_A"), reply_t::STATUS_GONE);
  EXPECT_EQ(status_of_lost_page("PLANEMAP_REPLY_B"), reply_t::STATUS_OK);
  EXPECT_EQ(status_of_lost_page("PLANEMAP_REPLY_C"), reply_t::STATUS_OK);
}

TEST_F(RequestAnswererTest, LostPagesOfAQueryAreThoseOfTheSameQuestion) {
  const auto snapshot = walls_.snapshot();
  const auto reply = ask(nearest_request(100, 1), snapshot);
  ASSERT_GT(reply.end, 1u) << "several pages";
  std::size_t near = 0;
  for (const auto& page : decoded<reply_t>(*reply.pages)) near += page.near_planes.size();
  EXPECT_EQ(near, 100u);
  auto again = nearest_request(100, 1);
  again.page = 1;
  again.epoch = 9;
  again.revision = static_cast<std::int64_t>(snapshot->revision());
  walls_.look_at(750, 1.5);
  const auto lost = ask(again, walls_.snapshot());
  ASSERT_EQ(lost.begin, 1u);
  EXPECT_EQ((*lost.pages)[1], (*reply.pages)[1]);
  auto other = nearest_request(50, 1);  // another question: never a page of that answer
  other.page = 1;
  other.epoch = again.epoch;
  other.revision = again.revision;
  EXPECT_EQ(only_page(ask(other, snapshot)).status, reply_t::STATUS_GONE);
}

TEST_F(RequestAnswererTest, TheSameQuestionTwiceGetsTheSameAnswer) {
  const auto snapshot = walls_.snapshot();
  const auto first = ask(nearest_request(3, 1), snapshot);
  EXPECT_EQ(ask(nearest_request(3, 1), snapshot).pages, first.pages) << "made once";
  EXPECT_EQ(ask(nearest_request(3, 1, "PLANEMAP_REPLY_B"), snapshot).pages, first.pages);
  EXPECT_NE(ask(nearest_request(4, 1), snapshot).pages, first.pages);
}

}  // namespace
}  // namespace planemap::service
