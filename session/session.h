// SPDX-License-Identifier: Apache-2.0
/// Sessions of tactus::codec over a network: <tactus/tactus.h>, and
///   session/session_server.h   SessionServer: true states to datagrams for many clients; its head says how to drive both ends
///   session/session_client.h   SessionClient: datagrams to what the client shows, and the samples of a device back
/// Their options, session/session_options.h, come with them. examples/session.cpp is a whole program.
#pragma once

#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include <tactus/tactus.h>
