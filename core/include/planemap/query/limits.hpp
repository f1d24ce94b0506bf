#pragma once

namespace planemap {

/// Coordinates in queries, at most: beyond, doubles say less than a nanometre of a place, and cells have no number.
constexpr double kMaxQueryCoordinateM = 1e6;

/// Closer than this to a border, or to a plane, is on it: what rounding does to coordinates of a few hundred metres.
constexpr double kOnBorderM = 1e-9;

/// A ray with a smaller cosine to a plane's normal runs along the plane and meets nothing of it.
constexpr double kLeastCosine = 1e-9;

}  // namespace planemap
