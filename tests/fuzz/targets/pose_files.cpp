#include <string_view>

#include "folder_frame.hpp"
#include "fuzz_input.hpp"
#include "text_file.hpp"
#include "tum_trajectory.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace planemap;
  using namespace planemap::fuzz;
  Input input(data, size);
  const std::size_t kind = take_choice(input, 3);
  const std::string text(input.begin(), input.end());
  if (kind == 0) {
    const auto T = sources::parse_rigid_transform(text);
    require(!T || (T->matrix().allFinite() && std::abs(T->rotation().determinant() - 1.0) < 1e-6),
            "no rigid transform");
  } else if (kind == 1) {
    constexpr auto kLatest = static_cast<std::int64_t>(1e6 * sources::kMaxTumSeconds);
    const auto path = sources::TumTrajectory::parse(text);
    for (const std::int64_t utime : {std::int64_t{0}, std::int64_t{1'305'031'098'000'000}, kLatest, -kLatest}) {
      const auto T = path.at(utime, 1'000'000);
      require(!T || T->matrix().allFinite(), "a pose that is not finite");
    }
  } else {
    (void)sources::parse_camera_parameters(text);
  }
  return 0;
}
