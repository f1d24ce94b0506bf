#pragma once

#include <nlohmann/json.hpp>
#include <planemap/client/query_types.hpp>
#include <vector>

namespace planemap::cli {

using Json = nlohmann::ordered_json;

// Answers as JSON: keys as in planes.json; metres, radians, square metres.

Json json_of(const client::Vector3& vector);
/// Polygons in two coordinates.
Json json_of(const std::vector<client::Polygon>& polygons);
/// The same in the world, by a plane's basis.
Json json_of(const std::vector<client::Polygon>& polygons, const client::Plane& basis);
Json json_of(const client::Cell& cell);
Json json_of(const client::Plane& plane);
/// {"epoch", "revision"}, to which the rest is added.
Json json_of(const client::MapVersion& version);
/// Finite numbers as they are; JSON has no infinity: null.
Json json_of_number(double number);

}  // namespace planemap::cli
