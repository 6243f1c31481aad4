// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/guide_text.h"

#include <cmath>
#include <span>
#include <string>

#include "keepout/error.h"
#include "keepout/robot/chain.h"
#include "text_fields.h"

namespace keepout {
namespace {

using text::Fields;
using text::in_quotes;
using text::number;
using text::point;
using text::split;

using Part = std::span<const std::string_view>;

Region region_of(Part f) {
  if (f.size() == 3 && f[0] == "half_space") return Region::half_space(point(f[1]), point(f[2]));
  if (f.size() == 4 && f[0] == "slab") return Region::slab(point(f[1]), point(f[2]), number(f[3]));
  if (f.size() == 4 && f[0] == "tube") return Region::tube(point(f[1]), point(f[2]), number(f[3]));
  if (f.size() == 3 && f[0] == "ball") return Region::ball(point(f[1]), number(f[2]));
  throw Error(text::misfit(f[0],
                           {"half_space", "slab", "tube", "ball", "point", "axis", "remote_center"},
                           "guide or region"));
}

int link_of(std::string_view field) {
  const double link = number(field);
  if (link >= 0.0 && link <= Chain::most_joints && link == std::floor(link)) {
    return static_cast<int>(link);
  }
  throw Error(in_quotes(field) +
              " is not the number of a link: 0 is the base, and a chain has at most " +
              std::to_string(Chain::most_joints) + " more");
}

/// The name before the sign, or else the form, and the fields of the rest.
struct Named {
  std::string name;
  Fields fields;
};

Named named_fields(std::string_view text) {
  const std::size_t sign = text.find('=');
  const std::string_view rest = sign == std::string_view::npos ? text : text.substr(sign + 1);
  Named named{.name = std::string(text.substr(0, sign)), .fields = split(rest, ':')};
  if (sign == std::string_view::npos) named.name = named.fields[0];
  if (named.name.empty()) throw Error("its name is empty");
  return named;
}

Guide guide_of(const std::string& name, Part f) {
  if (f.size() > 3 && f[0] == "point") {
    return Guide::point(name, {link_of(f[1]), point(f[2])}, region_of(f.subspan(3)));
  }
  if (f.size() == 5 && f[0] == "axis") {
    return Guide::axis(name, link_of(f[1]), point(f[2]), point(f[3]), number(f[4]));
  }
  if (f.size() == 7 && f[0] == "remote_center") {
    return Guide::remote_center(name, {link_of(f[1]), point(f[2])}, {link_of(f[3]), point(f[4])},
                                point(f[5]), number(f[6]));
  }
  return Guide::point(name, region_of(f));
}

}  // namespace

Guide guide_of_text(std::string_view text) {
  try {
    const Named named = named_fields(text);
    return guide_of(named.name, named.fields);
  } catch (const Error& error) {
    throw Error("the guide " + in_quotes(text) + ": " + error.what() +
                "; write [NAME=]REGION for a tip, or [NAME=] and one of " +
                std::string(guide_forms) + " for an instrument, where REGION is " +
                std::string(region_forms));
  }
}

}  // namespace keepout
