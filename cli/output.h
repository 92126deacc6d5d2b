// SPDX-License-Identifier: Apache-2.0
/// Output files that are either whole or not there.
#pragma once

#include <fstream>
#include <initializer_list>
#include <iosfwd>
#include <memory>
#include <string>

#include "cli/messages.h"

namespace tactus::cli {

/// Removes a file when an interrupt, a hang-up or a request to end stops the program.
class RemovedOnSignal {
 public:
  explicit RemovedOnSignal(std::string path);
  ~RemovedOnSignal();
  RemovedOnSignal(const RemovedOnSignal&) = delete;
  RemovedOnSignal& operator=(const RemovedOnSignal&) = delete;

 private:
  const std::string path_;
};

/// Something to write to PATH: goes to PATH.part and takes the name PATH when keep() is called; otherwise it is removed. "-" is
/// standard output; that and what is not a plain file (a pipe, a device) are written directly.
class OutputFile {
 public:
  enum class Existing { keep, replace };
  /// err  PATH is empty, exists and is to be kept, or is one of the files that the command reads or writes besides
  static Outcome check_free(const std::string& path, Existing existing, std::initializer_list<std::string> others = {});
  static tl::expected<OutputFile, Failure> create(const std::string& path, Existing existing,
                                                  std::initializer_list<std::string> others = {});
  /// The same, but where nothing is yet, the file grows under its own name and stays, finished or not: for what a crash leaves
  /// readable.
  static tl::expected<OutputFile, Failure> create_growing(const std::string& path, Existing existing,
                                                          std::initializer_list<std::string> others = {});

  const std::string& path() const noexcept { return path_; }
  const std::string& working_path() const noexcept { return working_path_; }  ///< where to write; "-": standard output
  bool is_temporary() const noexcept { return path_ != working_path_; }       ///< a plain file that can be read back
  bool stays() const noexcept { return unfinished_ == Unfinished::stays; }    ///< unfinished, too
  /// Open working_path() for writing; standard output if that is "-".   pre  called once
  tl::expected<std::ostream*, Failure> open();
  Outcome keep();
  /// Remove what stays unfinished: it holds nothing yet.   pre  keep() was not called
  void discard() noexcept;

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

 private:
  enum class Unfinished { goes, stays };
  OutputFile(std::string path, std::string working_path, Unfinished unfinished)
      : path_(std::move(path)), working_path_(std::move(working_path)), unfinished_(unfinished) {}

  std::string path_, working_path_;
  Unfinished unfinished_;
  // Both stay where they are when the file is moved.
  std::unique_ptr<RemovedOnSignal> removal_;
  std::unique_ptr<std::ofstream> stream_;
};

/// All bytes of a file, "-" is standard input.
tl::expected<std::string, Failure> read_file(const std::string& path);

/// What was printed has reached its reader or its file.
Outcome check_standard_output();

}  // namespace tactus::cli
