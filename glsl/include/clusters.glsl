// Which cluster of source texels a ray is aimed at: by the weights that its texel's group gives them (weights.comp).
#ifndef CLUSTERS_GLSL
#define CLUSTERS_GLSL

layout(set = 0, binding = 34, std430) readonly buffer Clusters { Cluster clusters[]; };
layout(set = 0, binding = 35, std430) readonly buffer ClusterTexels { uint cluster_texels[]; };
layout(set = 0, binding = 36, std430) readonly buffer ClusterSums { float cluster_sums[]; };
layout(set = 0, binding = 37, r32ui) readonly uniform uimage2D seats_image;
// [group][cluster]: sums of weights up to and with this one.
layout(set = 0, binding = 38, std430) readonly buffer Weights { float weights[]; };

const uint CLUSTER_BITS = 10u;

uint cluster_of(uvec2 texel) {
    return imageLoad(seats_image, ivec2(texel)).x & ((1u << CLUSTER_BITS) - 1u);
}

// Where in the table the weights of a texel's group begin.
uint row_of(uvec2 texel) {
    return (imageLoad(seats_image, ivec2(texel)).x >> CLUSTER_BITS) * uint(clusters.length());
}

float total_weight(uint row) {
    return weights[row + uint(clusters.length()) - 1u];
}

float weight_before(uint row, uint cluster) {
    return cluster > 0u ? weights[row + cluster - 1u] : 0.0;
}

// A cluster's share of all weights.
float share_of(uint row, uint cluster) {
    float total = total_weight(row);
    return total > 0.0 ? (weights[row + cluster] - weight_before(row, cluster)) / total : 0.0;
}

// The cluster that `u` in [0,1) chooses. What is left of it chooses within the cluster: bits that it has lost are made up
// for by `fresh`. False: there is none.
bool choose_cluster(uint row, float fresh, inout float u, out uint cluster) {
    float total = total_weight(row);
    float x = u * total;
    uint low = 0u, high = uint(clusters.length()) - 1u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (x < weights[row + middle]) high = middle;
        else low = middle + 1u;
    }
    cluster = low;
    float before = weight_before(row, cluster);
    float weight = weights[row + cluster] - before;
    if (!(weight > 0.0)) return false;
    u = clamp((x - before + fresh * (total / 16777216.0)) / weight, 0.0, 0.99999994);
    return true;
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
