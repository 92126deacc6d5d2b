// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study.h"

namespace tactus::sim::study {

const char* name(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::stable:
      return "stable";
    case Verdict::limit:
      return "limit";
    case Verdict::diverges:
      return "diverges";
  }
  return "";
}

}  // namespace tactus::sim::study
