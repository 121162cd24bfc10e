// What a ray sees that leaves the scene.
#ifndef SKY_GLSL
#define SKY_GLSL

layout(set = 0, binding = 7) uniform sampler2D sky_map;

// Cosine of the angle from straight up at which a row begins.
float sky_row_cosine(int row, int rows) {
    return cos(float(row) * (PI / float(rows)));
}

// Angle about the vertical at which a column begins.
float sky_column_angle(float column, int columns) {
    return 2.0 * PI * (column / float(columns) - 0.5);
}

// Whether a direction lies beyond the border at which a column begins.
bool beyond_column(vec3 direction, int column, int columns) {
    float angle = sky_column_angle(float(column), columns);
    return cos(angle) * direction.z - sin(angle) * direction.x >= 0.0;
}

// The inverse functions are off by up to 1.6e-4 on lavapipe, a tenth of a row of 2048: what they guess is put right by the
// very borders that rays are aimed between, else aimed rays would see the next pixel.
ivec2 sky_pixel(vec3 direction) {
    ivec2 size = textureSize(sky_map, 0);
    vec2 uv = vec2(atan(direction.z, direction.x) / (2.0 * PI) + 0.5, acos(clamp(direction.y, -1.0, 1.0)) / PI);
    ivec2 pixel = clamp(ivec2(uv * vec2(size)), ivec2(0), size - 1);
    if (pixel.y > 0 && direction.y > sky_row_cosine(pixel.y, size.y)) --pixel.y;
    else if (pixel.y < size.y - 1 && direction.y < sky_row_cosine(pixel.y + 1, size.y)) ++pixel.y;
    if (size.x < 4) return pixel;
    if (!beyond_column(direction, pixel.x, size.x)) pixel.x = (pixel.x + size.x - 1) % size.x;
    else if (beyond_column(direction, pixel.x + 1, size.x)) pixel.x = (pixel.x + 1) % size.x;
    return pixel;
}

// Of a pixel in this row; as a product, for the cosines of a pole's row differ by little.
float sky_solid_angle(uint row, uvec2 size) {
    float rows = PI / float(size.y);
    return 2.0 * PI / float(size.x) * 2.0 * sin((float(row) + 0.5) * rows) * sin(0.5 * rows);
}

vec3 sky_radiance(vec3 direction) {
    return SKY_MAP ? texelFetch(sky_map, sky_pixel(direction), 0).rgb : push.sky;
}

#endif
