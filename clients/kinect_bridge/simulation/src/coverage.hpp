#pragma once

#include <planemap/simulation/surface.hpp>
#include <vector>

#include "apartment.hpp"
#include "tour.hpp"

namespace planemap::simulation {

constexpr double kLargeSurfaceM2 = 0.25;  ///< surfaces above this are to be found by a mapper, so a tour shows them

/// The large surfaces of which a tour shows too little near enough and at less than a grazing angle, when it is
/// recorded in few frames.
std::vector<Surface> poorly_seen(const Tour& tour, const Apartment& apartment, const std::vector<Surface>& surfaces);

}  // namespace planemap::simulation
