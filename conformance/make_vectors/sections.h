// SPDX-License-Identifier: Apache-2.0
/// Sections of the specification that vectors are about: number of the chapter, title.
#pragma once

namespace tactus::conformance::section {

inline constexpr const char* kDeclaration = "20 Layout";
inline constexpr const char* kBounds = "20 Bounds";
inline constexpr const char* kStiffness = "20 Stiffness";
inline constexpr const char* kLimits = "20 Limits and memory";
inline constexpr const char* kSubstreams = "25 Substreams";
inline constexpr const char* kBaselines = "25 Baselines";
inline constexpr const char* kNumbers = "25 Sequence numbers";
inline constexpr const char* kSymbols = "30 Symbols";
inline constexpr const char* kRigidPacket = "40 Packet";
inline constexpr const char* kPrediction = "40 Prediction";
inline constexpr const char* kPose = "40 Pose";
inline constexpr const char* kDriven = "40 Driven objects";
inline constexpr const char* kMotion = "40 Motion";
inline constexpr const char* kStartModels = "40 Start models";
inline constexpr const char* kLoadPacket = "45 Packet";
inline constexpr const char* kDeformable = "20 Deformable objects";
inline constexpr const char* kRings = "50 Rings and area of interest";
inline constexpr const char* kCodingOrder = "50 Coding order";
inline constexpr const char* kParents = "50 Parents";
inline constexpr const char* kWeights = "50 Weights";
inline constexpr const char* kHead = "50 Packet of profile main";
inline constexpr const char* kTriangle = "50 Triangle";
inline constexpr const char* kLayers = "50 Layers";
inline constexpr const char* kVertexBounds = "50 Bounds and steps";
inline constexpr const char* kTime = "50 Temporal prediction";
inline constexpr const char* kVertices = "50 Vertices";
inline constexpr const char* kThesis = "50 Packet of profile thesis";
inline constexpr const char* kDeformableStartModels = "50 Start models";
inline constexpr const char* kComputedBasis = "50 Computed basis";
inline constexpr const char* kClusters = "50 Clusters";
inline constexpr const char* kElastic = "20 Elastic bodies";

inline constexpr const char* kTouch = "55 Touch";
inline constexpr const char* kStep = "55 Step";
inline constexpr const char* kShown = "55 Shown";
inline constexpr const char* kClient = "60 Applying an update";
inline constexpr const char* kShownPose = "60 Shown pose";
inline constexpr const char* kPlayout = "60 Playout";
inline constexpr const char* kEased = "60 Eased paths";
inline constexpr const char* kDatagram = "70 Datagram";
inline constexpr const char* kJoining = "70 Joining and leaving";
inline constexpr const char* kAcknowledgements = "70 Numbers and acknowledgements";
inline constexpr const char* kFragments = "70 Fragments";
inline constexpr const char* kPieces = "70 Scene declaration and epochs";
inline constexpr const char* kFile = "80 Records";

}  // namespace tactus::conformance::section
