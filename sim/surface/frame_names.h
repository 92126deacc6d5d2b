// SPDX-License-Identifier: Apache-2.0
/// The files of an animation: which names of a folder are frames, in which order, and when. Internal to the library.
#pragma once

#include <string>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/trace/read_notes.h>

namespace tactus::sim {

struct FrameFile {
  std::string name;
  double offset = 0;  ///< [frame periods] after the first
};

/// Order files by the number in which their names differ, which may have a sign in front and a decimal point. A step is the difference that
/// occurs most; missing numbers keep their time.
/// in   files   names in one folder, without it
/// in   series  keep only names of this form, * stands for anything; empty: all
/// err  R-SEQ-2 none is left; R-SEQ-5 they are several series, or a number is there twice
tl::expected<std::vector<FrameFile>, Diagnostic> order_frames(std::vector<std::string> files, const std::string& series,
                                                              ReadNotes& notes);

/// Hidden files, copies and backups, by their names: no frames.
bool is_backup(const std::string& name);

}  // namespace tactus::sim
