// SPDX-License-Identifier: Apache-2.0
/// Everything of tactus::codec. Shapes, units and costs stand in the headers below.
#pragma once

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/client/replica.h>
#include <tactus/deformable/decoder.h>
#include <tactus/deformable/displacement.h>
#include <tactus/deformable/encoder.h>
#include <tactus/file/stream_file.h>
#include <tactus/packet/substream.h>
#include <tactus/rigid/contact.h>
#include <tactus/rigid/rigid.h>
#include <tactus/rigid/rigid_decoder.h>
#include <tactus/rigid/rigid_encoder.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/bounds.h>
#include <tactus/scene/deformable_object.h>
#include <tactus/scene/scene_syntax.h>
