// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/registry.h"

#include <array>
#include <string>
#include <utility>

#include "keepout/activation/all_faces.h"
#include "keepout/activation/paper.h"
#include "keepout/error.h"

namespace keepout {
namespace {

template <class Rule>
std::unique_ptr<Activation> make(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<Rule>(std::move(mesh));
}

constexpr std::array rules{
    ActivationEntry{"all_faces", "a plane for every face in reach: the naive baseline",
                    make<AllFaces>},
    ActivationEntry{"paper", "Algorithm 1 of Li et al. 2020: for comparison, not always safe",
                    make<PaperRule>},
};

}  // namespace

std::span<const ActivationEntry> activation_rules() noexcept { return rules; }

std::unique_ptr<Activation> make_activation(std::string_view name,
                                            std::shared_ptr<const Mesh> mesh) {
  std::string known;
  for (const ActivationEntry& entry : rules) {
    if (entry.name == name) return entry.make(std::move(mesh));
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw Error("there is no activation rule '" + std::string(name) + "'; known: " + known);
}

}  // namespace keepout
