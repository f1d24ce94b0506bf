#pragma once

#include <Eigen/Core>
#include <planemap/uncertain_grid.hpp>
#include <vector>

namespace planemap::experiments {

// The paper's drawings, Fig. 1 and Fig. 2(a), worked out by the code. All lengths in units of the cell.

/// A point in a layer of cells, with its standard errors.
struct FlatPoint {
  Eigen::Vector2d p_cells;
  Eigen::Vector2d sigma_cells;
};

/// One cell that may win the new point of Fig. 1.
struct Rival {
  CellIndex cell;
  Eigen::Vector2d fixed_cells;    ///< middle of the cube
  Eigen::Vector2d virtual_cells;  ///< Eq. 1
  Eigen::Vector2d sigma_cells;    ///< of the virtual centre
  double expected_cells = 0.0;    ///< root of Eq. 7's expected squared distance to the new point
  bool holds = false;             ///< the new point lies in it
  bool wins = false;              ///< the assignment gives the new point to it
};

/// Fig. 1: four cells with points, and a new point.
struct AssignmentExample {
  std::vector<FlatPoint> points;
  FlatPoint next;
  std::vector<Rival> rivals;
};
AssignmentExample assignment_example();

/// One virtual centre of Fig. 2(a), in the section along x.
struct SectionCentre {
  Eigen::Vector2d at_cells;    ///< x and z
  double sigma_cells = 0.0;    ///< along z
  Eigen::Vector2d low_cells;   ///< moved so that the plane turns one way
  Eigen::Vector2d high_cells;  ///< and the other
};

/// Fig. 2(a): a plane through the centres, and planes through the perturbed ones.
struct MinMaxExample {
  std::vector<SectionCentre> centres;
  Eigen::Vector2d middle_cells;  ///< of the plane
  double tilt_rad = 0.0;         ///< of the fitted plane against x
  double low_tilt_rad = 0.0;     ///< of the plane fitted to the centres moved one way
  double high_tilt_rad = 0.0;    ///< and the other
  double deviation_rad = 0.0;    ///< by the closed form (min_max_deviation_rad)
};
MinMaxExample min_max_example();

}  // namespace planemap::experiments
