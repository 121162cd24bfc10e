// Which cluster of source texels a ray is aimed at, as seen from the texel that it starts from: by power over squared
// distance, by the cosines at both ends, and by what rays from there have found before.
#ifndef CLUSTERS_GLSL
#define CLUSTERS_GLSL

#include "scene.glsl"

layout(set = 0, binding = 34, std430) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 35, std430) readonly buffer ClusterTexels { uint cluster_texels[]; };
layout(set = 0, binding = 36, std430) readonly buffer ClusterSums { float cluster_sums[]; };
layout(set = 0, binding = 37, r32ui) readonly uniform uimage2D seats_image;
layout(set = 0, binding = 38, std430) readonly buffer Visibility { float visibility[]; };

const uint CLUSTER_BITS = 10u;
// Of what shines under the horizon or away, as far as a cluster's middle tells: some of it may not.
const float LEAST_COSINE = 0.1;
// No weight is larger, so that no sum of them is beyond 32-bit floats.
const float MOST_WEIGHT = 1e35;

// How a texel sees the clusters.
struct View {
    vec3 position;
    vec3 normal;
    uint row;     // in the table of visibilities
    float total;  // of all weights
};

// Where in the clusters a texel's rays have come, which are aimed at one after the other.
struct Walk {
    uint cluster;
    float below;
    float weight;
};

uint cluster_of(uvec2 texel) {
    return imageLoad(seats_image, ivec2(texel)).x & ((1u << CLUSTER_BITS) - 1u);
}

uint row_of(uvec2 texel) {
    return (imageLoad(seats_image, ivec2(texel)).x >> CLUSTER_BITS) * uint(clusters.length());
}

float weight_of(View v, uint index) {
    vec3 way = clusters[index].centre - v.position;
    float spread = clusters[index].spread;
    float inverse = inversesqrt(max(dot(way, way) + spread * spread, 1e-30));
    // From afar the cosines of its middle; in the midst of it, where they tell nothing, toward 1.
    float received = clamp((dot(v.normal, way) + 0.5 * spread) * inverse, LEAST_COSINE, 1.0);
    float sent = clamp(clusters[index].even + (0.5 * spread - dot(clusters[index].axis, way)) * inverse, LEAST_COSINE, 1.0);
    float weight = clusters[index].power * (received * inverse * (sent * inverse));
    if (VISIBILITY) weight *= visibility[v.row + index];
    return min(weight, MOST_WEIGHT);
}

Walk start_walk(View v) {
    return Walk(0u, 0.0, CLUSTERS ? weight_of(v, 0u) : 0.0);
}

float total_of(View v) {
    float total = 0.0;
    for (uint index = 0u; index < uint(clusters.length()); ++index) total += weight_of(v, index);
    return total;
}

// The cluster that `choice` in [0,1) chooses, and in `u` how far into its share, with bits that `choice` does not have from
// `fresh`; choices grow from call to call.
bool choose_cluster(View v, float choice, float fresh, inout Walk walk, out float u) {
    float x = choice * v.total;
    while (x >= walk.below + walk.weight && walk.cluster + 1u < uint(clusters.length())) {
        walk.below += walk.weight;
        ++walk.cluster;
        walk.weight = weight_of(v, walk.cluster);
    }
    u = clamp((x - walk.below + fresh * v.total / 16777216.0) / walk.weight, 0.0, 0.99999994);
    return walk.weight > 0.0;
}

// The texel of a cluster that `u` chooses by its leaf.
uvec2 choose_texel(uint cluster, float u) {
    float x = u * clusters[cluster].power;
    uint low = clusters[cluster].first, high = low + clusters[cluster].count - 1u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (x < cluster_sums[middle]) high = middle;
        else low = middle + 1u;
    }
    return uvec2(cluster_texels[low] & 0xffffu, cluster_texels[low] >> 16u);
}

#endif
