#version 460
// What rays that were aimed at a cluster from a group of texels have shown: which share of them found it.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 38, std430) writeonly buffer Visibility { float visibility[]; };
layout(set = 0, binding = 39, std430) buffer Sightings { uint sightings[]; };

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (index >= push.texel_count) return;
    index += push.first_texel;
    uint counts = sightings[index];
    uint tried = counts & 0xffffu, seen = counts >> 16u;
    // A cluster whose rays find it with probability v adds least variance when it is aimed at in proportion to sqrt(v).
    // Before any has been tried half are thought to be seen.
    visibility[index] = max(sqrt((float(seen) + 0.5) / (float(tried) + 1.0)), 0.05);
    // Old counts make room for new ones; where things move they are soon worth nothing.
    if (DYNAMIC || tried >= 0x8000u) sightings[index] = (tried / 2u) | (seen / 2u) << 16u;
}
