// Counter-based random numbers: the same key gives the same numbers, in any order of work.
#ifndef RANDOM_GLSL
#define RANDOM_GLSL

// Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Four numbers in [0,1) for a texel's sample. `dimension` counts the calls for one sample; it is spread over all bits, so
// that no seed a person would choose shares its numbers.
vec4 random4(uint texel, uint sample_index, uint dimension) {
    uvec4 bits = pcg4d(uvec4(texel, sample_index, push.seed.x, push.seed.y ^ dimension * 0x9e3779b9u));
    return vec4(bits >> 8u) * (1.0 / 16777216.0);
}

#endif
