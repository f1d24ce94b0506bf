#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>

#include "export/colour.hpp"
#include "export/floor_plan.hpp"
#include "export/formats.hpp"
#include "export/xml_text.hpp"

namespace planemap {
namespace {

// Pixels.
constexpr double kMargin = 36.0;
constexpr double kTitleHeight = 64.0;
constexpr double kFooterHeight = 56.0;
constexpr double kLegendWidth = 250.0;
constexpr double kLegendRow = 19.0;
constexpr double kMaxPlanWidth = 980.0;
constexpr double kMaxPlanHeight = 720.0;
constexpr double kMinPlanSide = 240.0;
constexpr double kMaxScale = 180.0;  // per metre
constexpr double kWallWidth = 4.5;
constexpr std::size_t kLegendRows = 28;
constexpr double kLabelledWallM = 0.9;
constexpr double kLabelledAreaM2 = 0.25;

constexpr std::string_view kStyle = R"(<style>
text{font-family:'DejaVu Sans',Helvetica,Arial,sans-serif;fill:#2b303a}
.title{font-size:20px;font-weight:bold}.sub{font-size:12px;fill:#69707d}
.legend{font-size:12px}.head{font-size:12px;font-weight:bold}.num{text-anchor:end}
.label{font-size:10px;text-anchor:middle;dominant-baseline:central;paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}
.grid{stroke:#e9ecf1;stroke-width:1}.bar{stroke:#2b303a;stroke-width:2;fill:none}
.axis{stroke:#69707d;stroke-width:1.5;fill:none}
</style>
)";

/// Draws one floor plan. Plan coordinates are metres, y up; the page's are pixels, y down.
class Drawing {
 public:
  Drawing(const ExportMap& map, std::ostream& out) : map_(map), plan_(floor_plan_of(map)), to_(out) { lay_out(); }

  void draw() {
    print(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0:.0f}" height="{1:.0f}" viewBox="0 0 {0:.0f} {1:.0f}">)"
          "\n",
          page_width_, page_height_);
    print("<title>Floor plan of {}</title>\n{}", escaped(map_.frame), kStyle);
    print(R"(<rect width="100%" height="100%" fill="#ffffff"/>)"
          "\n");
    draw_title();
    draw_grid();
    for (const PlanArea& area : plan_.areas) draw_area(area);
    for (const PlanWall& wall : plan_.walls) draw_segments(wall, wall.extent, 1.4, 0.7);
    for (const PlanWall& wall : plan_.walls) draw_segments(wall, wall.standing, kWallWidth, 1.0);
    for (const PlanArea& area : plan_.areas) label_area(area);
    for (const PlanWall& wall : plan_.walls) label_wall(wall);
    draw_scale_bar();
    draw_axes();
    draw_legend();
    print("</svg>\n");
  }

 private:
  template <class... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(to_, format, std::forward<Args>(args)...);
  }

  void lay_out() {
    Point2 size_m = plan_.max_m - plan_.min_m;
    if (size_m.y() > size_m.x()) {  // pages are wider than high
      const PlanAxes upright = plan_.frame;
      plan_.frame.axis_x = upright.axis_y;
      plan_.frame.axis_y = -upright.axis_x;
      turned_ = true;
      std::swap(size_m.x(), size_m.y());
    }
    size_m = size_m.cwiseMax(Point2::Constant(1e-3));
    scale_ = std::min({kMaxPlanWidth / size_m.x(), kMaxPlanHeight / size_m.y(), kMaxScale});
    plan_width_ = std::max(size_m.x() * scale_, kMinPlanSide);
    const double legend_height = kLegendRow * static_cast<double>(std::min(map_.planes.size(), kLegendRows) + 6);
    plan_height_ = std::max({size_m.y() * scale_, kMinPlanSide, legend_height - kFooterHeight});
    offset_ = {kMargin + (plan_width_ - size_m.x() * scale_) / 2.0,
               kTitleHeight + kMargin + (plan_height_ - size_m.y() * scale_) / 2.0};
    page_width_ = plan_width_ + 3.0 * kMargin + kLegendWidth;
    page_height_ = kTitleHeight + plan_height_ + 2.0 * kMargin + kFooterHeight;
  }

  /// From the plan's metres, as floor_plan_of gave them, to the page.
  Point2 page(const Point2& p) const {
    const Point2 from_corner = turned_ ? Point2(p.y() - plan_.min_m.y(), p.x() - plan_.min_m.x())
                                       : Point2(p.x() - plan_.min_m.x(), plan_.max_m.y() - p.y());
    return offset_ + scale_ * from_corner;
  }
  /// The same for directions, of length 1.
  Point2 page_direction(const Point2& v) const { return turned_ ? Point2(v.y(), v.x()) : Point2(v.x(), -v.y()); }

  double right() const { return kMargin + plan_width_; }
  double top() const { return kTitleHeight + kMargin; }
  double bottom() const { return top() + plan_height_; }

  void draw_title() {
    print(R"(<text class="title" x="{}" y="36">Floor plan</text>)"
          "\n",
          kMargin);
    double level_m2 = 0.0;
    for (const PlanArea& area : plan_.areas) level_m2 += area.floor ? area.area_m2 : 0.0;
    std::string floor = level_m2 > 0.0 ? fmt::format(", {:.1f} m² of floor", level_m2) : std::string();
    if (!map_.gravity) floor = ", gravity not known: −z is taken for down";
    print(R"(<text class="sub" x="{}" y="56">{} planes, {} cells{} · frame {}, revision {} of map {}</text>)"
          "\n",
          kMargin, map_.planes.size(), map_.cell_count, floor, escaped(map_.frame), map_.revision, map_.epoch);
  }

  /// Lines a metre apart: distances can be read anywhere, not only at the scale bar.
  void draw_grid() {
    const double right_x = right();
    const auto columns = static_cast<int>((right_x + 0.5 - kMargin) / scale_);
    for (int i = 0; i <= columns; ++i) {
      print(R"(<path class="grid" d="M{:.1f} {:.1f}V{:.1f}"/>)"
            "\n",
            kMargin + i * scale_, top(), bottom());
    }
    const auto rows = static_cast<int>((bottom() - (top() - 0.5)) / scale_);
    for (int i = 0; i <= rows; ++i) {
      print(R"(<path class="grid" d="M{:.1f} {:.1f}H{:.1f}"/>)"
            "\n",
            kMargin, bottom() - i * scale_, right_x);
    }
  }

  void draw_area(const PlanArea& area) {
    print(R"(<path id="plane-{}" fill-rule="evenodd" d=")", area.id);
    for (const auto& ring : area.rings) {
      char command = 'M';
      for (const Point2& p_m : ring) {
        const Point2 p = page(p_m);
        print("{}{:.1f} {:.1f}", command, p.x(), p.y());
        command = 'L';
      }
      print("Z");
    }
    const std::string line = colour_of(area.id, 0.5).hex();
    print(R"(" fill="{}" fill-opacity="{}" stroke="{}" stroke-width="{}"{}/>)"
          "\n",
          colour_of(area.id, area.floor ? 0.92 : 0.8).hex(), area.floor ? 1.0 : 0.9, line, area.floor ? 0.6 : 1.0,
          area.leaning ? R"( stroke-dasharray="5 3")" : "");
  }

  void draw_segments(const PlanWall& wall, const std::vector<PlanSegment>& segments, double width, double opacity) {
    // The surface is the stroke's edge, the stroke the wall behind it: two faces of a thin wall stay two lines.
    const Point2 behind = -0.5 * width * page_direction(wall.normal);
    for (const PlanSegment& segment : segments) {
      const Point2 a = page(segment.from) + behind;
      const Point2 b = page(segment.to) + behind;
      print(R"(<path d="M{:.1f} {:.1f}L{:.1f} {:.1f}" stroke="{}" stroke-width="{}" stroke-opacity="{}"/>)"
            "\n",
            a.x(), a.y(), b.x(), b.y(), colour_of(wall.id).hex(), width, opacity);
    }
  }

  void label(const Point2& at, PlaneId id) {
    print(R"(<text class="label" x="{:.1f}" y="{:.1f}" style="fill:{}">{}</text>)"
          "\n",
          at.x(), at.y(), colour_of(id, 0.3).hex(), id);
  }

  void label_area(const PlanArea& area) {
    if (area.area_m2 < kLabelledAreaM2 || area.rings.empty()) return;
    Point2 sum = Point2::Zero();
    for (const Point2& p_m : area.rings.front()) sum += page(p_m);
    label(sum / static_cast<double>(area.rings.front().size()), area.id);
  }

  void label_wall(const PlanWall& wall) {
    const auto length = [](const PlanSegment& s) { return (s.to - s.from).norm(); };
    const auto longest = std::max_element(wall.extent.begin(), wall.extent.end(),
                                          [&](const auto& a, const auto& b) { return length(a) < length(b); });
    if (longest == wall.extent.end() || length(*longest) < kLabelledWallM) return;
    label(page((longest->from + longest->to) / 2.0) + 11.0 * page_direction(wall.normal), wall.id);
  }

  void draw_scale_bar() {
    constexpr std::array kLengthsM = {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0};
    double length_m = kLengthsM.front();
    for (const double candidate_m : kLengthsM) {
      if (candidate_m * scale_ <= plan_width_ / 3.0) length_m = candidate_m;
    }
    const double y = bottom() + kMargin + 12.0;
    const double end = kMargin + length_m * scale_;
    print(R"(<path class="bar" d="M{0:.1f} {2:.1f}v8H{1:.1f}v-8M{3:.1f} {4:.1f}v-5"/>)"
          "\n",
          kMargin, end, y - 4.0, (kMargin + end) / 2.0, y + 4.0);
    print(R"(<text class="legend" x="{:.1f}" y="{:.1f}">{:g} m</text>)"
          "\n",
          end + 8.0, y + 4.0, length_m);
  }

  /// Which way the world's x and y point on the page.
  void draw_axes() {
    const Point2 origin(right() - 60.0, bottom() + kMargin + 12.0);
    const std::array<Eigen::Vector3d, 3> axes = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                                 Eigen::Vector3d::UnitZ()};
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Point2 direction(axes[i].dot(plan_.frame.axis_x), -axes[i].dot(plan_.frame.axis_y));
      if (direction.norm() < 0.5) continue;  // upright, or nearly
      const Point2 tip = origin + 24.0 * direction;
      const Point2 text = origin + 33.0 * direction;
      print(R"(<path class="axis" d="M{:.1f} {:.1f}L{:.1f} {:.1f}"/>)"
            "\n",
            origin.x(), origin.y(), tip.x(), tip.y());
      print(R"(<text class="label" x="{:.1f}" y="{:.1f}">{}</text>)"
            "\n",
            text.x(), text.y(), "xyz"[i]);
    }
  }

  void draw_legend() {
    const double x = right() + kMargin;
    double y = top() + 10.0;
    const auto key = [&](const std::string& mark, const std::string& text) {
      print(R"({}<text class="legend" x="{:.1f}" y="{:.1f}">{}</text>)"
            "\n",
            mark, x + 34.0, y + 4.0, text);
      y += kLegendRow;
    };
    const auto line = [&](double width) {
      return fmt::format(R"(<path d="M{:.1f} {:.1f}h24" stroke="#69707d" stroke-width="{}"/>)", x, y, width);
    };
    key(line(kWallWidth), fmt::format("upright, {:g} to {:g} m above the floor", kCutLowM, kCutHighM));
    key(line(1.4), "upright, lower or higher");
    key(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="24" height="12" fill="#dfe3ea" stroke="#69707d"/>)", x,
                    y - 6.0),
        "seen from above (ceilings left out)");
    y += kLegendRow * 0.6;
    print(
        R"(<text class="head" x="{0:.1f}" y="{3:.1f}">plane</text><text class="head" x="{1:.1f}" y="{3:.1f}">class</text>)"
        R"(<text class="head num" x="{2:.1f}" y="{3:.1f}">area</text>)"
        "\n",
        x + 22.0, x + 80.0, x + kLegendWidth - 30.0, y + 4.0);
    y += kLegendRow;

    std::vector<const ExportPlane*> planes;
    for (const ExportPlane& plane : map_.planes) planes.push_back(&plane);
    std::stable_sort(planes.begin(), planes.end(), [](const ExportPlane* a, const ExportPlane* b) {
      return a->outline.area_m2 > b->outline.area_m2;
    });
    for (std::size_t i = 0; i < std::min(planes.size(), kLegendRows); ++i, y += kLegendRow) draw_row(*planes[i], x, y);
    if (planes.size() > kLegendRows) {
      print(R"(<text class="sub" x="{:.1f}" y="{:.1f}">and {} more</text>)"
            "\n",
            x + 22.0, y + 4.0, planes.size() - kLegendRows);
    }
  }

  void draw_row(const ExportPlane& plane, double x, double y) {
    print(R"(<rect x="{:.1f}" y="{:.1f}" width="14" height="10" rx="2" fill="{}"/>)", x, y - 5.0,
          colour_of(plane.record.id).hex());
    print(
        R"(<text class="legend" x="{0:.1f}" y="{3:.1f}">{4}</text><text class="legend" x="{1:.1f}" y="{3:.1f}">{5}</text>)"
        R"(<text class="legend num" x="{2:.1f}" y="{3:.1f}">{6:.2f} m²</text>)"
        "\n",
        x + 22.0, x + 80.0, x + kLegendWidth - 30.0, y + 4.0, plane.record.id, name_of(plane.plane_class),
        plane.outline.area_m2);
  }

  const ExportMap& map_;
  FloorPlan plan_;
  std::ostreambuf_iterator<char> to_;
  bool turned_ = false;  ///< a quarter of a turn clockwise, against floor_plan_of's axes
  double scale_ = 1.0;   ///< pixels per metre
  double plan_width_ = 0.0;
  double plan_height_ = 0.0;
  double page_width_ = 0.0;
  double page_height_ = 0.0;
  Point2 offset_ = Point2::Zero();  ///< of the plan's upper left corner
};

}  // namespace

void write_floor_plan_svg(const ExportMap& map, std::ostream& out) {
  Drawing(map, out).draw();
}

}  // namespace planemap
