// Directions over the hemisphere.
#ifndef SAMPLING_GLSL
#define SAMPLING_GLSL

// Columns: tangent, bitangent, normal. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
// Neighbouring texels of a flat surface get the same frame, so that the same stratum means the same direction.
mat3 frame_of(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// A direction with density cos/pi about +z, from two numbers in [0,1).
vec3 cosine_direction(vec2 u) {
    float radius = sqrt(u.x);
    float angle = 2.0 * PI * u.y;
    return vec3(radius * cos(angle), radius * sin(angle), sqrt(max(0.0, 1.0 - u.x)));
}

// The point of stratum `index` of `count` equal ones that two numbers in [0,1) choose. They lie in rows; a square number
// of them is a grid, else some rows have one more.
vec2 stratified(uint index, uint count, vec2 u) {
    uint rows = uint(sqrt(float(count)) + 0.001);
    uint row = ((index + 1u) * rows - 1u) / count;
    uint first = row * count / rows;
    float columns = float((row + 1u) * count / rows - first);
    return vec2((float(index - first) + u.x) / columns, (float(first) + u.y * columns) / float(count));
}

#endif
