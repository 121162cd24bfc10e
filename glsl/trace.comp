#version 460
// Traces given rays: for tests, benchmarks and whoever wants to know what a back end answers.
#extension GL_GOOGLE_include_directive : require
#include "include/ray_query.glsl"

layout(local_size_x = 64) in;

// What is asked of each ray: 0 = what it hits first, 1 = whether it hits anything. A pipeline for each, so that a
// benchmark times one loop alone.
layout(constant_id = 2) const uint QUERY = 0u;
const uint CLOSEST = 0u;

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
    Ray ray = rays[index];
    if (QUERY == CLOSEST) {
        Hit hit = trace_closest(ray);
        uint instance = hit.committed ? hit.instance : NO_INSTANCE;
        answers[index] = Answer(hit.t, instance, hit.primitive, uint(hit.front_face), hit.barycentrics, 0u, 0u);
    } else {
        uint instance = trace_occluded(ray) ? 0u : NO_INSTANCE;
        answers[index] = Answer(ray.t_max, instance, 0u, 0u, vec2(0.0), 0u, 0u);
    }
}
