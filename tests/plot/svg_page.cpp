#include "plot/svg_page.hpp"

#include <spdlog/fmt/fmt.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "export/xml_text.hpp"

namespace planemap::plot {

namespace {

constexpr std::string_view kLight = R"(.page{fill:#ffffff}
text{font-family:'DejaVu Sans',Helvetica,Arial,sans-serif;font-size:12px;fill:#232836}
.title{font-size:17px;font-weight:bold}.head{font-size:13px;font-weight:bold}.soft{fill:#646b7a}
.mid{text-anchor:middle}.end{text-anchor:end}.small{font-size:11px}
path,line,polyline,circle,ellipse,rect,polygon{fill:none;stroke-linejoin:round;stroke-linecap:round}
.grid{stroke:#e7e9ef;stroke-width:1}.axis{stroke:#9097a6;stroke-width:1}.ink{stroke:#232836;stroke-width:1.4}
.halo{paint-order:stroke;stroke:#ffffff;stroke-width:3.5px;stroke-linejoin:round}
.dash{stroke-dasharray:5 4}.wide{stroke-width:2.2}.thin{stroke-width:1}.fat{stroke-width:3}
.s0{stroke:#2563c9}.s1{stroke:#d23f31}.s2{stroke:#218a55}.s3{stroke:#c47a0c}.s4{stroke:#7d4bc4}.s5{stroke:#747b8a}
.f0{fill:#2563c9}.f1{fill:#d23f31}.f2{fill:#218a55}.f3{fill:#c47a0c}.f4{fill:#7d4bc4}.f5{fill:#747b8a}
.pale{fill-opacity:.18}.solid{stroke:none}
)";
constexpr std::string_view kDark = R"(.page{fill:#15181e}
text{fill:#e3e6ed}.soft{fill:#9aa2b2}
.grid{stroke:#2a2f3a}.axis{stroke:#6d7585}.ink{stroke:#e3e6ed}.halo{stroke:#15181e}
.s0{stroke:#6ba1ff}.s1{stroke:#ff7a6b}.s2{stroke:#4fc98a}.s3{stroke:#f0b04a}.s4{stroke:#b58cf5}.s5{stroke:#9aa2b2}
.f0{fill:#6ba1ff}.f1{fill:#ff7a6b}.f2{fill:#4fc98a}.f3{fill:#f0b04a}.f4{fill:#b58cf5}.f5{fill:#9aa2b2}
)";

std::string list_of(std::span<const Pixel> points) {
  std::string list;
  for (const Pixel& p : points) fmt::format_to(std::back_inserter(list), "{:.1f},{:.1f} ", p.x(), p.y());
  if (!list.empty()) list.pop_back();
  return list;
}

}  // namespace

SvgPage::SvgPage(double width, double height, std::string_view title, std::string_view subtitle)
    : width_(width), height_(height), title_(title), light_(kLight), dark_(kDark) {
  text({24.0, 32.0}, title, "text title");
  if (!subtitle.empty()) text({24.0, 52.0}, subtitle, "soft");
}

void SvgPage::style(std::string_view light, std::string_view dark) {
  light_ += light;
  dark_ += dark;
}

void SvgPage::text(const Pixel& at, std::string_view text, std::string_view classes, double turn_deg) {
  std::string turn;
  if (turn_deg != 0.0) turn = fmt::format(" transform=\"rotate({:.1f} {:.1f} {:.1f})\"", turn_deg, at.x(), at.y());
  body_ += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", classes, at.x(), at.y(), turn,
                       escaped(text));
}

void SvgPage::line(const Pixel& from, const Pixel& to, std::string_view classes) {
  body_ += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", classes,
                       from.x(), from.y(), to.x(), to.y());
}

void SvgPage::arrow(const Pixel& from, const Pixel& to, std::string_view stroke_class, std::string_view fill_class) {
  constexpr double kHead = 8.0;
  const Pixel along = (to - from).normalized();
  const Pixel across(-along.y(), along.x());
  line(from, to - 0.8 * kHead * along, stroke_class);
  const Pixel back = to - kHead * along;
  polygon(std::array<Pixel, 3>{to, back + 0.4 * kHead * across, back - 0.4 * kHead * across}, fill_class);
}

void SvgPage::polyline(std::span<const Pixel> points, std::string_view classes) {
  body_ += fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n", classes, list_of(points));
}

void SvgPage::polygon(std::span<const Pixel> points, std::string_view classes) {
  body_ += fmt::format("<polygon class=\"{}\" points=\"{}\"/>\n", classes, list_of(points));
}

void SvgPage::circle(const Pixel& middle, double radius, std::string_view classes) {
  body_ += fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n", classes, middle.x(),
                       middle.y(), radius);
}

void SvgPage::ellipse(const Pixel& middle, double radius_x, double radius_y, std::string_view classes) {
  body_ += fmt::format("<ellipse class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" rx=\"{:.1f}\" ry=\"{:.1f}\"/>\n", classes,
                       middle.x(), middle.y(), radius_x, radius_y);
}

void SvgPage::rectangle(const Box& box, std::string_view classes) {
  body_ += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n", classes,
                       box.x, box.y, box.width, box.height);
}

std::string SvgPage::svg() const {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n"
      "<title>{2}</title>\n<style>\n{3}@media (prefers-color-scheme:dark){{\n{4}}}\n</style>\n"
      "<rect class=\"page\" width=\"100%\" height=\"100%\"/>\n{5}</svg>\n",
      width_, height_, escaped(title_), light_, dark_, body_);
}

void SvgPage::save(const std::filesystem::path& file) const {
  std::ofstream out(file, std::ios::binary);
  out << svg();
  out.close();
  if (!out) throw std::runtime_error(file.string() + " can't be written");
}

}  // namespace planemap::plot
