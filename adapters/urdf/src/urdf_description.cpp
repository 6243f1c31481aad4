// SPDX-License-Identifier: BSD-3-Clause
#include "urdf_description.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <exception>
#include <mutex>

#include "keepout/error.h"
#include "xml_bounds.h"

namespace keepout {
namespace {

/// Freeing a model recurses over the links of the longest chain.
constexpr std::size_t most_joints_of_robot = 1000;

/// console_bridge has one handler for all threads.
std::mutex console;

/// Collects urdfdom's messages during its life, so that urdfdom prints nothing.
class HeardMessages : private console_bridge::OutputHandler {
 public:
  HeardMessages() {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  }
  ~HeardMessages() override {
    console_bridge::setLogLevel(level_before_);
    // Called twice: console_bridge also keeps the previous handler, which must not be this object.
    console_bridge::useOutputHandler(handler_before_);
    console_bridge::useOutputHandler(handler_before_);
  }
  HeardMessages(const HeardMessages&) = delete;
  HeardMessages& operator=(const HeardMessages&) = delete;

  std::string text;

 private:
  void log(const std::string& message, console_bridge::LogLevel, const char*, int) override {
    if (!text.empty()) text += "; ";
    text += message;
  }
  const std::lock_guard<std::mutex> lock_{console};
  console_bridge::OutputHandler* const handler_before_ = console_bridge::getOutputHandler();
  const console_bridge::LogLevel level_before_ = console_bridge::getLogLevel();
};

std::string attribute(const TiXmlElement* element, const char* name) {
  const char* value = element != nullptr ? element->Attribute(name) : nullptr;
  return value != nullptr ? value : "";
}

[[noreturn]] void refuse_two_parents(const std::string& link, const std::string& first,
                                     const std::string& second) {
  throw Error("link '" + link + "' is the child of joint '" + first + "' and of joint '" + second +
              "', and a link has one parent: remove one of them");
}

/// Throws Error if a link has two parents, or is below itself. urdfdom accepts a link with two
/// parents. If a link is below itself, urdfdom does not say where, and leaks memory.
void require_tree(const std::map<std::string, const TiXmlElement*>& joints) {
  struct Above {
    std::string link;
    std::string joint;
  };
  std::map<std::string, Above> above;
  for (const auto& [joint, element] : joints) {
    const std::string child = attribute(element->FirstChildElement("child"), "link");
    const std::string parent = attribute(element->FirstChildElement("parent"), "link");
    const auto [place, is_new] = above.insert({child, {parent, joint}});
    if (!is_new) refuse_two_parents(child, place->second.joint, joint);
  }
  for (auto start = above.begin(); start != above.end(); ++start) {
    std::size_t steps = 0;
    for (auto at = start; at != above.end(); at = above.find(at->second.link)) {
      if (++steps <= above.size()) continue;
      throw Error("joint '" + at->second.joint + "' is part of a loop: link '" + at->first +
                  "' is below itself. A robot is a tree from its base on: remove a joint");
    }
  }
}

/// Returns the text with cylinders in place of capsules, which urdfdom does not know: it would
/// reject the robot. The chain does not depend on shapes.
std::string without_capsules(const std::string& xml, const TiXmlDocument& document) {
  if (xml.find("<capsule") == std::string::npos) return xml;
  TiXmlDocument copy(document);
  TiXmlElement* const robot = copy.RootElement();
  for (TiXmlElement* link = robot->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    for (TiXmlElement* part = link->FirstChildElement(); part != nullptr;
         part = part->NextSiblingElement()) {
      TiXmlElement* const geometry = part->FirstChildElement("geometry");
      if (geometry == nullptr) continue;
      if (TiXmlElement* const capsule = geometry->FirstChildElement("capsule")) {
        capsule->SetValue("cylinder");
      }
    }
  }
  TiXmlPrinter printer;
  printer.SetStreamPrinting();
  copy.Accept(&printer);
  return printer.Str();
}

}  // namespace

UrdfDescription describe(std::string_view text) {
  require_bounded_xml(text);
  const std::string xml(text);
  UrdfDescription read{
      .model = nullptr, .document = std::make_shared<TiXmlDocument>(), .joints = {}};
  read.document->Parse(xml.c_str());
  if (read.document->Error()) {
    throw Error("not XML: " + std::string(read.document->ErrorDesc()) + " Line " +
                std::to_string(read.document->ErrorRow()) + ": repair it there");
  }
  const TiXmlElement* robot = read.document->RootElement();
  if (robot == nullptr || robot->ValueStr() != "robot" || robot->NextSiblingElement() != nullptr) {
    throw Error("no URDF: one element <robot> must hold all others. Expand a file of xacro first");
  }
  for (const TiXmlElement* part = robot->FirstChildElement(); part != nullptr;
       part = part->NextSiblingElement()) {
    if (!part->ValueStr().starts_with("xacro:")) continue;  // urdfdom would ignore it
    throw Error("contains <" + part->ValueStr() +
                ">, which is xacro; expand it first: xacro FILE > robot.urdf");
  }
  for (const TiXmlElement* joint = robot->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    if (read.joints.emplace(attribute(joint, "name"), joint).second) continue;
    throw Error("two joints are called '" + attribute(joint, "name") + "': rename one of them");
  }
  if (read.joints.size() > most_joints_of_robot) {
    throw Error("more than " + std::to_string(most_joints_of_robot) + " joints: leave some out");
  }
  require_tree(read.joints);

  HeardMessages messages;
  try {
    read.model = urdf::parseURDF(without_capsules(xml, *read.document));
  } catch (const std::exception& thrown) {
    messages.text = thrown.what();
  }
  if (read.model == nullptr) {
    const bool may_be_xacro = xml.find("xacro") != std::string::npos;
    throw Error("no URDF" +
                std::string(may_be_xacro
                                ? " (if it is xacro, expand it first: xacro FILE > robot.urdf)"
                                : "") +
                ": " + messages.text + ". Repair it there");
  }
  return read;
}

}  // namespace keepout
