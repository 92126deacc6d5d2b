// SPDX-License-Identifier: Apache-2.0
/// Everything of tactus::codec. Shapes, units and costs stand in the headers below.
#pragma once

#include "codec/base/geometry.h"
#include "codec/base/result.h"
#include "codec/client/replica.h"
#include "codec/mesh/mesh.h"
#include "codec/mesh/mesh_decoder.h"
#include "codec/mesh/mesh_encoder.h"
#include "codec/mesh/mesh_object.h"
#include "codec/rigid/contact.h"
#include "codec/rigid/rigid.h"
#include "codec/rigid/rigid_decoder.h"
#include "codec/rigid/rigid_encoder.h"
#include "codec/rigid/trigger.h"
#include "codec/stream/bounds.h"
#include "codec/stream/file.h"
#include "codec/stream/header.h"
#include "codec/stream/part.h"
