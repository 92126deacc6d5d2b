// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_error.h>

#include <algorithm>
#include <array>
#include <string_view>

#include <tactus/base/shown.h>

namespace tactus::sim {
namespace {

struct RuleText {
  std::string_view rule;
  const char* broken;
  const char* remedy;
};

constexpr std::array kRules{
    RuleText{"R-SRF-1", "the file cannot be opened, read or written", "check that the path is right and that you may use it"},
    RuleText{"R-SRF-2", "more than 512 MiB, 2^20 vertices or 2^21 triangles", "simplify the surface"},
    RuleText{"R-SRF-3", "not a surface file that can be read here", "give .obj, .ply, .stl or .off; the last not binary"},
    RuleText{"R-SRF-4", "the file does not have the form that its name promises", "check that it is whole, or write it again"},
    RuleText{"R-SRF-5", "not everything in the file could be read",
             "the file was cut, or these elements are degenerate; write it again"},
    RuleText{"R-SRF-6", "the polygon cannot be cut into triangles from one of its corners", "write the surface as triangles"},
    RuleText{"R-SRF-7", "there is no triangle in it", "give a surface, not points or curves"},
    RuleText{"R-SEQ-1", "the folder cannot be read", "give the folder that holds the frames"},
    RuleText{"R-SEQ-2", "not a folder with frames of one format", "keep one .obj, .ply or .off file per frame in it"},
    RuleText{"R-SEQ-3", "STL does not say which vertex is which", "give the frames as .obj, .ply or .off"},
    RuleText{"R-SEQ-4", "the frame is not the first one's mesh",
             "write all frames with the same vertices and faces in the same order"},
    RuleText{"R-TGN-1", "the program that fills surfaces is not there", "apt-get install tetgen"},
    RuleText{"R-TGN-2", "the surface is not closed",
             "close the hole beside this triangle, or merge vertices that only look the same"},
    RuleText{"R-TGN-3", "the surface cuts or touches itself", "take the two triangles apart"},
    RuleText{"R-TGN-4", "the surface encloses no volume: it looks inward", "turn all of its triangles round"},
    RuleText{"R-TGN-5", "filling takes too long or too many tetrahedra", "allow larger ones, or a longer time"},
    RuleText{"R-TGN-6", "the program that fills surfaces failed", "look for overlapping or nearly touching parts of the surface"},
    RuleText{"R-TGN-7", "the size or quality asked for is not possible", "give a volume above 0 and a quality of at least 1.1"},
    RuleText{"R-TGN-8", "a vertex belongs to no triangle, or two have one place", "remove or merge it"},
    RuleText{"R-TGN-9", "the tetrahedra do not fill what the surface encloses",
             "fill each closed part by itself; there must be no cavities"},
};

}  // namespace

std::string to_string(const SurfaceError& error) {
  constexpr std::size_t kMostOfDetail = 120;  // a place in our words and a piece of the file
  const std::string_view rule = error.error.rule;
  const std::string file = error.file.empty() ? "" : shown_path(error.file) + ": ";
  const auto* text = std::find_if(kRules.begin(), kRules.end(), [&](const RuleText& r) { return r.rule == rule; });
  if (text == kRules.end()) return file + to_string(MeshError{error.error, error.element});
  const std::string place = file + (error.detail.empty() ? "" : shown(error.detail, kMostOfDetail) + ": ") + error.error.rule;
  return place + ": " + text->broken + "; " + text->remedy;
}

}  // namespace tactus::sim
