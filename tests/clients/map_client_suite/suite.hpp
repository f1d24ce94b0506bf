#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <chrono>
#include <memory>
#include <ostream>
#include <planemap/client/map_client.hpp>
#include <string>

#include "support/grpc_door.hpp"
#include "support/room_service.hpp"

namespace planemap::client {

constexpr std::chrono::milliseconds kLong(30000);
constexpr std::chrono::milliseconds kShort(50);

/// A way to a service, and the door to it where it needs one of its own.
struct Way {
  std::unique_ptr<GrpcDoor> door;  ///< first: it outlives the client
  std::unique_ptr<MapClient> client;
};

struct Implementation {
  const char* name;
  Way (*make)(RoomService& room);
};
inline void PrintTo(const Implementation& implementation, std::ostream* out) {
  *out << implementation.name;
}

/// What every MapClient does, whichever way it reaches the map: a real service that has looked around, asked beside the
/// core's own queries.
class MapClientSuite : public testing::TestWithParam<Implementation> {
 protected:
  MapClientSuite() { room_.look_around(); }

  static Eigen::Vector3d vector_of(const Vector3& v) { return {v[0], v[1], v[2]}; }
  static Vector3 array_of(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
  std::shared_ptr<const SnapshotQueries> core() { return room_.service().queries(); }
  std::int64_t id_of_class(PlaneClass wanted) {
    for (const auto& plane : core()->planes()) {
      if (plane.plane_class == wanted) return static_cast<std::int64_t>(plane.record->id);
    }
    return 0;
  }
  void expect_newest(const MapVersion& version) {
    EXPECT_EQ(version.epoch, 1234);
    EXPECT_EQ(version.revision, static_cast<std::int64_t>(room_.service().snapshot()->revision()));
  }

  RoomService room_;
  Way way_ = GetParam().make(room_);
  MapClient* client_ = way_.client.get();
};

/// The same of a map without gravity, and with nothing in it.
class EmptyMapSuite : public testing::TestWithParam<Implementation> {
 protected:
  RoomService room_{service::ServiceConfig{}};
  Way way_ = GetParam().make(room_);
  MapClient* client_ = way_.client.get();
};

}  // namespace planemap::client
