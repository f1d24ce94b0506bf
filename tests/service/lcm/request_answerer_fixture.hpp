#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <planemap_lcm/reply_t.hpp>
#include <string>
#include <vector>

#include "lcm/walls.hpp"
#include "serve/lcm/request_answerer.hpp"

namespace planemap::service {

/// Asks about a wall, in pages of 4,096 bytes; the last two replies are kept.
class RequestAnswererTest : public testing::Test {
 protected:
  RequestAnswererTest() : book_(config_.map), answerer_(make_config(), book_) { walls_.look_at(1000); }

  static ServiceConfig make_config() {
    ServiceConfig config;
    config.publish.page_bytes = 4096;
    config.publish.kept_replies = 2;
    return config;
  }
  Reply ask(Request request, std::shared_ptr<const MapSnapshot> snapshot) {
    return answerer_.answer(
        request, snapshot, [] { return planemap_lcm::status_t{}; }, 123);
  }
  static Request request_for(std::int16_t operation, const std::string& channel = "PLANEMAP_REPLY_A") {
    Request request;
    request.request_id = 7;
    request.reply_channel = channel;
    request.operation = operation;
    return request;
  }
  static planemap_lcm::reply_t only_page(const Reply& reply) {
    EXPECT_EQ(reply.end - reply.begin, 1u);
    return decoded<planemap_lcm::reply_t>({(*reply.pages)[reply.begin]})[0];
  }

  ServiceConfig config_;
  PlaneBook book_;
  RequestAnswerer answerer_;
  Walls walls_;
};

/// A request for the planes nearest to so many points.
inline Request nearest_request(std::int32_t points, std::int32_t count,
                               const std::string& channel = "PLANEMAP_REPLY_A") {
  Request request;
  request.request_id = 7;
  request.reply_channel = channel;
  request.operation = planemap_lcm::request_t::OPERATION_NEAREST;
  planemap_lcm::nearest_query_t query{};
  query.count = count;
  query.points.resize(static_cast<std::size_t>(points));
  query.n_points = points;
  request.arguments.nearest = {query};
  request.arguments.n_nearest = 1;
  request.argument_bytes = {static_cast<std::uint8_t>(points), static_cast<std::uint8_t>(count)};
  return request;
}

}  // namespace planemap::service
