// SPDX-License-Identifier: Apache-2.0
/// Output files that are either whole or not there.
#pragma once

#include <cstdint>
#include <fstream>
#include <iosfwd>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/report/messages.h"

namespace tactus::cli {

/// From now on an interrupt, a hang-up or a request to end removes what is unfinished. Handlers that others set later stay.
void remove_unfinished_on_signals();

/// Removes a file, or a folder that is empty, when an interrupt, a hang-up or a request to end stops the program.
class RemovedOnSignal {
 public:
  explicit RemovedOnSignal(std::string path);
  ~RemovedOnSignal();
  RemovedOnSignal(const RemovedOnSignal&) = delete;
  RemovedOnSignal& operator=(const RemovedOnSignal&) = delete;

 private:
  const std::string path_;
};

/// An open file of the operating system.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) noexcept : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor();
  int number() const noexcept { return number_; }
  bool is_open() const noexcept { return number_ >= 0; }

 private:
  int number_;
};

/// As long as it is there, others who change a file in the same folder wait, where the file system has locks. The file is replaced, so that a
/// lock of its own would be gone, and a file for the lock would be left behind.
Descriptor lock_beside(const std::string& path);

/// Something to write to PATH: goes to a new file beside it, whose name nobody can foresee, and takes the name PATH when keep() is
/// called; otherwise it is removed. Links are never followed, neither at PATH nor at the other name, and two that write to one PATH
/// never mix. "-" is standard output; that and what is not a plain file (a pipe, a device) are written directly.
class OutputFile {
 public:
  enum class Existing { keep, replace };
  /// err  PATH is empty, exists and is to be kept, or names one of the files that the command also reads or writes
  static Outcome check_free(const std::string& path, Existing existing, const std::vector<std::string>& others = {});
  /// err  as check_free(); the operating system refuses
  static tl::expected<OutputFile, Failure> create(const std::string& path, Existing existing,
                                                  const std::vector<std::string>& others = {});
  /// The same, but where nothing is yet, the file grows under its own name and stays, finished or not: for what a crash leaves
  /// readable.
  static tl::expected<OutputFile, Failure> create_growing(const std::string& path, Existing existing,
                                                          const std::vector<std::string>& others = {});

  const std::string& path() const noexcept { return path_; }
  /// What to open for writing, or for reading back: names the open file itself, whoever renames it; "-": standard output.
  const std::string& working_path() const noexcept { return working_path_; }
  bool is_temporary() const noexcept { return kind_ == Kind::temporary; }  ///< a plain file that can be read back
  bool stays() const noexcept { return kind_ == Kind::growing; }           ///< unfinished, too
  /// Open working_path() for writing; standard output if that is "-".   pre  called once
  tl::expected<std::ostream*, Failure> open();
  /// err  it cannot be written; a file to be kept has come to PATH meanwhile
  Outcome keep();
  /// Remove what stays unfinished: it holds nothing yet.   pre  keep() was not called
  void discard() noexcept;

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

 private:
  enum class Kind { direct, temporary, growing, kept };
  OutputFile(std::string path, Existing existing, Kind kind) : path_(std::move(path)), existing_(existing), kind_(kind) {}
  Outcome open_temporary();
  Outcome open_directly();
  void remove_own() noexcept;

  std::string path_, name_, working_path_;  // name_: of a plain file that is not finished
  Existing existing_;
  Kind kind_;
  Descriptor file_;
  // Both stay where they are when the file is moved.
  std::unique_ptr<RemovedOnSignal> removal_;
  std::unique_ptr<std::ofstream> stream_;
};

/// A new folder inside or beside another, whose name nobody can foresee, removed with all that is in it.
class AsideFolder {
 public:
  /// Makes PARENT/.NAME.xxxxxxxx.   err  the operating system refuses
  static tl::expected<AsideFolder, Failure> create(const std::string& parent, const std::string& name);
  const std::string& path() const noexcept { return path_; }
  /// Give it its final name, where nothing may be but an empty folder.   err  the operating system refuses
  Outcome keep_as(const std::string& path);

  AsideFolder(AsideFolder&& other) noexcept : path_(std::exchange(other.path_, {})), removal_(std::move(other.removal_)) {}
  AsideFolder& operator=(AsideFolder&&) = delete;
  ~AsideFolder();

 private:
  explicit AsideFolder(std::string path) : path_(std::move(path)), removal_(std::make_unique<RemovedOnSignal>(path_)) {}
  std::string path_;  // empty: kept
  std::unique_ptr<RemovedOnSignal> removal_;
};

/// A whole file.   err  it is there already and to be kept; it cannot be written
Outcome write_file(const std::string& path, const std::string& bytes, OutputFile::Existing existing);

inline constexpr std::uint64_t kMostRead = 512U << 20;  ///< [bytes] of a file that is read whole

/// All bytes of a file, "-" is standard input.   err  it cannot be read; it is a folder; it has more than `most` bytes
tl::expected<std::string, Failure> read_file(const std::string& path, std::uint64_t most = kMostRead);

/// What was printed has reached its reader or its file.
Outcome check_standard_output();

}  // namespace tactus::cli
