#include "export/exporter.hpp"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "export/cells_ply.hpp"
#include "export/formats.hpp"

namespace planemap::cli {
namespace {

namespace fs = std::filesystem;

using StreamWriter = void (*)(const ExportMap&, std::ostream&);

/// Writes through a stream, and looks whether all of it arrived.
template <StreamWriter write>
Expected<void> write_stream(const ExportMap& map, const fs::path& path) {
  std::ofstream out(path, std::ios::binary);
  write(map, out);
  out.close();
  if (!out) return fail(path.string() + ": can't be written; is the disk full, or the folder read-only?");
  return {};
}

struct Format {
  const char* extension;
  const char* what;
  Expected<void> (*write)(const ExportMap& map, const fs::path& path);
};

constexpr std::array<Format, 4> kFormats = {{{".json", "planes", write_stream<write_planes_json>},
                                             {".csv", "cells", write_stream<write_cells_csv>},
                                             {".ply", "cells coloured by plane", write_cells_ply},
                                             {".svg", "floor plan", write_stream<write_floor_plan_svg>}}};

const Format* format_of(const fs::path& path) {
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const Format& format) { return path.extension() == format.extension; });
  return found == kFormats.end() ? nullptr : found;
}

}  // namespace

std::string known_formats() {
  std::string text;
  for (const Format& format : kFormats) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", format.extension, format.what);
  }
  return text;
}

Expected<void> check_export_path(const fs::path& path) {
  if (format_of(path) == nullptr) {
    return fail(fmt::format("{}: no format is known for that extension; known are {}", path.string(), known_formats()));
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return fail(fmt::format("{}: there is no folder {}", path.string(), folder.string()));
  }
  if (fs::is_directory(path, error)) return fail(path.string() + ": is a folder");
  return {};
}

Expected<void> export_to(const ExportMap& map, const fs::path& path) {
  if (auto usable = check_export_path(path); !usable) return usable;
  // Beside the target, so that renaming stays within one file system; whoever looks sees the old file or the new one.
  fs::path part = path;
  part += fmt::format(".{}.part", ::getpid());
  std::error_code error;
  if (auto written = format_of(path)->write(map, part); !written) {
    fs::remove(part, error);
    return written;
  }
  fs::rename(part, path, error);
  if (error) {
    const std::string why = error.message();
    fs::remove(part, error);
    return fail(path.string() + ": " + why);
  }
  return {};
}

}  // namespace planemap::cli
