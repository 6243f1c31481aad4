// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/registry.h"

#include <array>

#include "keepout/activation/all_faces.h"
#include "keepout/activation/certified.h"
#include "keepout/activation/paper.h"

namespace keepout {
namespace {

template <class Rule>
std::unique_ptr<ActivationRule> make() {
  return std::make_unique<Rule>();
}

constexpr std::array rules{
    ActivationEntry{"all_faces", "a plane for every face in reach: the naive baseline",
                    make<AllFaces>},
    ActivationEntry{"paper", "Algorithm 1 of Li et al. 2020: for comparison, not always safe",
                    make<PaperRule>},
    ActivationEntry{"certified", "only motions that are proven to keep their distance",
                    make<CertifiedRule>},
};

}  // namespace

Registry<ActivationEntry> activation_rules() noexcept { return {"activation rule", rules}; }

std::unique_ptr<ActivationRule> make_activation(std::string_view name) {
  return activation_rules().named(name).make();
}

}  // namespace keepout
