#version 460
// Traces given rays: for tests, benchmarks and whoever wants to know what a back end answers.
#extension GL_GOOGLE_include_directive : require
#include "include/ray_query.glsl"

layout(local_size_x = 64) in;

// A hit; `instance` is NO_INSTANCE for a miss.
struct Answer {
    float t;
    uint instance;
    uint primitive;
    uint front_face;
    vec2 barycentrics;
    uint pad0;
    uint pad1;
};

layout(set = 0, binding = 24, std430) readonly buffer Rays { Ray rays[]; };
layout(set = 0, binding = 25, std430) writeonly buffer Answers { Answer answers[]; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= push.texel_count) return;
    Hit hit = trace_closest(rays[index]);
    bool occluded = trace_occluded(rays[index]);
    uint instance = hit.committed ? hit.instance : NO_INSTANCE;
    // The two queries of one ray have to agree; a primitive that none has tells the host that they do not.
    uint primitive = occluded == hit.committed ? hit.primitive : 0xffffffffu;
    answers[index] = Answer(hit.t, instance, primitive, uint(hit.front_face), hit.barycentrics, 0u, 0u);
}
