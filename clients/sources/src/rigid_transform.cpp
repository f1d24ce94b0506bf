#include "planemap/sources/rigid_transform.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "folder_frame.hpp"
#include "text_file.hpp"

namespace planemap::sources {
namespace {

constexpr double kUnitTolerance = 1e-3;
constexpr const char* kForms = "seven numbers x,y,z,qx,qy,qz,qw or the sixteen of a 4x4 matrix";

Expected<Eigen::Isometry3d> transform_of(const std::string& text, const std::vector<double>& numbers) {
  if (numbers.size() == 7) {
    const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
    if (std::abs(q.norm() - 1.0) > kUnitTolerance) return fail("the quaternion qx,qy,qz,qw is not of length 1");
    Eigen::Isometry3d transform(q.normalized());
    transform.pretranslate(Eigen::Vector3d(numbers[0], numbers[1], numbers[2]));
    return transform;
  }
  if (numbers.size() != 16) return fail(std::to_string(numbers.size()) + " numbers, where there should be " + kForms);
  const auto transform = parse_rigid_transform(text);
  if (!transform) return fail("the 4x4 matrix is no rigid transform: a rotation, a translation, last row 0 0 0 1");
  return *transform;
}

}  // namespace

Expected<Eigen::Isometry3d> read_transform(const std::string& numbers_or_file) {
  const auto spaced = [](std::string text) {
    std::replace(text.begin(), text.end(), ',', ' ');
    return text;
  };
  std::string text = spaced(numbers_or_file);
  std::string where;
  auto numbers = parse_numbers(text);
  if (!numbers) {
    auto content = read_text_file(numbers_or_file);
    if (!content) return fail(content.error().message + " (a file, or " + kForms + ")");
    where = numbers_or_file + ": ";
    text = spaced(*content);
    numbers = parse_numbers(text);
    if (!numbers) return fail(where + "holds other words than numbers");
  }
  auto transform = transform_of(text, *numbers);
  if (!transform) return fail(where + transform.error().message);
  return transform;
}

}  // namespace planemap::sources
