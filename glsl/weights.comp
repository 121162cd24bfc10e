#version 460
// How a group of texels chooses among the clusters: one work group weighs them all, as seen from the middle of the group,
// by power over squared distance, by the cosines at both ends, and by which share of the rays that were aimed at a cluster
// has found it. The table holds the sums of the weights, in order.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/surface.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 34, std430) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 35, std430) readonly buffer ClusterTexels { uint cluster_texels[]; };
layout(set = 0, binding = 38, std430) writeonly buffer Weights { float weights[]; };
layout(set = 0, binding = 39, std430) buffer Sightings { uint sightings[]; };
layout(set = 0, binding = 40, std430) readonly buffer GroupEnds { uint group_ends[]; };

// Of what shines under the horizon or away, as far as the middles tell: some of it may not.
const float LEAST_COSINE = 0.1;
// Of what was not seen: a texel may see what others of its group do not.
const float LEAST_VISIBILITY = 0.05;
// No weight is larger, so that no sum of them is beyond 32-bit floats.
const float MOST_WEIGHT = 1e35;

shared vec4 places[64];   // sums of places, and of their squared distances from the first
shared vec4 normals[64];  // sums of normals, and how many
shared float weighed[64];
shared float total;

// Where a group is: means, and the root of the mean squared distance from there.
struct Middle {
    vec3 place;
    float spread;
    vec3 normal;
};

Middle middle_of(uint first, uint end) {
    uint lane = gl_LocalInvocationIndex;
    places[lane] = normals[lane] = vec4(0.0);
    vec3 origin = vec3(0.0);
    for (uint index = first; index < end; index += 64u) {
        bool inside = index + lane < end;
        uint code = cluster_texels[inside ? index + lane : first];
        uvec2 texel = uvec2(code & 0xffffu, code >> 16u);
        Surface s = surface_of(texel, imageLoad(surface_image, ivec2(texel)));
        vec3 place = point_at(s, s.start);
        if (index == first) {
            if (lane == 0u) places[0].xyz = place;
            barrier();
            origin = places[0].xyz;
            barrier();
            if (lane == 0u) places[0] = vec4(0.0);
        }
        vec3 way = place - origin;
        // A sliver whose plane is no number has no place.
        if (inside && dot(way, way) < 1e36) {
            places[lane] += vec4(way, dot(way, way));
            normals[lane] += vec4(s.normal, 1.0);
        }
    }
    barrier();
    for (uint half_size = 32u; half_size > 0u; half_size /= 2u) {
        if (lane < half_size) {
            places[lane] += places[lane + half_size];
            normals[lane] += normals[lane + half_size];
        }
        barrier();
    }
    float count = max(normals[0].w, 1.0);
    vec4 place = places[0] / count;
    float spread = sqrt(max(place.w - dot(place.xyz, place.xyz), 0.0));
    return Middle(origin + place.xyz, spread, normals[0].xyz / count);
}

float weight_of(Middle from, Cluster c) {
    vec3 way = c.centre - from.place;
    float spread = sqrt(c.spread * c.spread + from.spread * from.spread);
    float inverse = inversesqrt(max(dot(way, way) + spread * spread, 1e-30));
    // From afar the cosines of the middles; in the midst of it, where they tell nothing, toward 1.
    float scattered = 0.5 * max(1.0 - length(from.normal), 0.0);
    float received = clamp(scattered + (dot(from.normal, way) + 0.5 * spread) * inverse, LEAST_COSINE, 1.0);
    float sent = clamp(c.even + (0.5 * spread - dot(c.axis, way)) * inverse, LEAST_COSINE, 1.0);
    return c.power * (received * inverse * (sent * inverse));
}

// A cluster whose rays find it with probability v adds least variance when it is aimed at in proportion to sqrt(v). Before
// any has been tried half are thought to be seen.
float visibility_of(uint entry) {
    uint counts = sightings[entry];
    uint tried = counts & 0xffffu, seen = counts >> 16u;
    // Old counts make room for new ones; where things move they are soon worth nothing.
    if (DYNAMIC || tried >= 0x8000u) sightings[entry] = (tried / 2u) | (seen / 2u) << 16u;
    return max(sqrt((float(seen) + 0.5) / (float(tried) + 1.0)), LEAST_VISIBILITY);
}

void main() {
    uint lane = gl_LocalInvocationIndex;
    uint group = push.first_texel + gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (group >= push.first_texel + push.texel_count) return;
    Middle from = middle_of(group > 0u ? group_ends[group - 1u] : 0u, group_ends[group]);
    uint count = uint(clusters.length());
    if (lane == 0u) total = 0.0;
    for (uint begin = 0u; begin < count; begin += 64u) {
        uint entry = group * count + begin + lane;
        float weight = 0.0;
        if (begin + lane < count) {
            weight = weight_of(from, clusters[begin + lane]);
            if (VISIBILITY) weight *= visibility_of(entry);
            // What is no number has none, and is then found by chance.
            weight = weight >= 0.0 ? min(weight, MOST_WEIGHT) : 0.0;
        }
        weighed[lane] = weight;
        barrier();
        // In order, for sums must not fall.
        if (lane == 0u) {
            for (uint i = 0u; i < 64u; ++i) weighed[i] = total += weighed[i];
        }
        barrier();
        if (begin + lane < count) weights[entry] = weighed[lane];
    }
}
