// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <tl/expected.hpp>

namespace tactus::device {

/// A library that is loaded while the program runs: nothing of it is needed to build but its header, if that. It stays loaded until the
/// program ends, since its threads may outlive what uses it.
class SharedLibrary {
 public:
  /// in   name  a path, or as the system looks for it: "libusb-1.0.so.0"
  /// err  why it cannot be loaded, as the system says it
  static tl::expected<SharedLibrary, std::string> load(const std::string& name);

  /// `function` is null afterwards if the library does not have it.
  template <class Function>
  void find(const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(symbol(name));
  }
  /// The first function that was not found; null: all were.
  const char* missing() const noexcept { return missing_; }

 private:
  explicit SharedLibrary(void* library) : library_(library) {}
  void* symbol(const char* name) noexcept;

  void* library_;
  const char* missing_ = nullptr;
};

}  // namespace tactus::device
