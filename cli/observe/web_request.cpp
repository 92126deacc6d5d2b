// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/web_request.h"

namespace tactus::cli {

WebAnswer judge(const WebRequest& request, std::uint16_t port) {
  const std::string suffix = ':' + std::to_string(port);
  const bool is_here = request.host == "127.0.0.1" + suffix || request.host == "localhost" + suffix;
  if (request.hosts != 1 || !is_here) return {421, "This server answers to http://127.0.0.1 and its port alone.\n"};
  if (request.target != kPageTarget && request.target != kLiveTarget) return {404, "There is / and nothing else.\n"};
  if (request.method != "GET") return {405, "Only GET is answered.\n"};
  if (request.target == kPageTarget) return {kPageAnswer};
  if (!request.upgrades) return {426, "This is a WebSocket; open / in a browser.\n"};
  if (request.origins != 1 || request.origin != "http://" + std::string(request.host))
    return {403, "Only the page of this server may observe it.\n"};
  return {kLiveAnswer};
}

}  // namespace tactus::cli
