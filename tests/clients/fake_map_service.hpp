#pragma once

#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <planemap_lcm/reply_t.hpp>
#include <planemap_lcm/request_t.hpp>
#include <string>
#include <vector>

namespace planemap::client {

/// A plane whose numbers all differ and depend on its id.
inline planemap_lcm::plane_t wire_plane(std::int64_t id) {
  planemap_lcm::plane_t plane{};
  const double base = static_cast<double>(id);
  plane.id = id;
  plane.normal[2] = 1.0;
  plane.d = -base;
  for (int i = 0; i < 10; ++i) plane.covariance[i] = 1e-6 * (i + 1);
  plane.centroid_m[0] = base + 0.5;
  plane.centroid_m[2] = base;
  plane.area_m2 = 0.75;
  plane.cell_count = 40 + static_cast<int>(id);
  plane.point_count = 1000 * id;
  plane.first_seen_utime = 10 * id;
  plane.last_seen_utime = 20 * id;
  plane.plane_class = "table";
  plane.quality = 0.9;
  plane.revision = 3;
  plane.origin_m[2] = base;
  plane.axis_u[0] = 1.0;
  plane.axis_v[1] = 1.0;
  planemap_lcm::polygon_t polygon{};
  polygon.ring_size = {4, 4};
  polygon.n_rings = 2;
  polygon.uv_m = {0, 0, 1, 0, 1, 1, 0, 1, 0.25F, 0.25F, 0.25F, 0.75F, 0.75F, 0.75F, 0.75F, 0.25F};
  polygon.n_values = static_cast<std::int32_t>(polygon.uv_m.size());
  plane.polygons = {polygon};
  plane.n_polygons = 1;
  return plane;
}

/// The far side of the wire: hears requests on a bus and answers as the test says.
class FakeMapService {
 public:
  using Answer = std::function<void(const planemap_lcm::request_t&)>;

  explicit FakeMapService(std::shared_ptr<lcm::LCM> bus) : bus_(std::move(bus)) {
    bus_->subscribe("PLANEMAP_REQUEST", &FakeMapService::on_request, this);
  }

  Answer answer;                                  ///< what to do with a request; nothing: stay silent
  std::vector<planemap_lcm::request_t> requests;  ///< all that came

  /// Page `page` of an answer of `count` pages; it holds the plane of id 100 + page.
  planemap_lcm::reply_t page_of(const planemap_lcm::request_t& request, int page, int count) const {
    planemap_lcm::reply_t reply{};
    reply.request_id = request.request_id;
    reply.epoch = 7;
    reply.revision = 42;
    reply.page = page;
    reply.page_count = count;
    reply.status = planemap_lcm::reply_t::STATUS_OK;
    reply.frame = "world";
    reply.planes = {wire_plane(100 + page)};
    reply.n_planes = 1;
    return reply;
  }

  void send(const planemap_lcm::request_t& request, const planemap_lcm::reply_t& reply) {
    bus_->publish(request.reply_channel, &reply);
  }

  void send_error(const planemap_lcm::request_t& request, std::int8_t status, const std::string& error) {
    planemap_lcm::reply_t reply{};
    reply.request_id = request.request_id;
    reply.page_count = 1;
    reply.status = status;
    reply.error = error;
    send(request, reply);
  }

 private:
  void on_request(const lcm::ReceiveBuffer*, const std::string&, const planemap_lcm::request_t* request) {
    requests.push_back(*request);
    if (answer) answer(*request);
  }

  std::shared_ptr<lcm::LCM> bus_;
};

}  // namespace planemap::client
