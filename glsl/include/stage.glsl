// What the benchmark's raster shaders share: the scene as its engine lays it out (engine/layout.rs).

struct Vertex {
    vec3 position; // in its object
    uint material;
    vec3 normal;
    uint mapped; // 0: it has no light-map coordinates and receives no light
    vec2 light_map_uv;
    vec2 albedo_uv;
    vec2 emission_uv;
    vec2 pad0;
};

struct Placing {
    vec4 object_to_world[3]; // rows; the world is relative to the scene's middle
    vec2 scale; // light-map coordinate * scale + offset = texel
    vec2 offset;
};

struct Surface {
    vec3 albedo;
    uint albedo_picture;
    vec3 emission;
    uint emission_picture;
};

// A texture as a material uses it.
struct Picture {
    uint first_pixel;
    uint width;
    uint height;
    uint wrap; // horizontally in the low byte, vertically in the next
};

const uint NO_PICTURE = 0xffffffffu;
const uint WRAP_REPEAT = 0u;
const uint WRAP_MIRRORED_REPEAT = 1u;

layout(set = 0, binding = 0, std140) uniform Frame {
    mat4 world_to_clip;
    mat4 world_to_sun; // to the shadow map's clip space
    vec3 eye;
    float exposure;
    vec3 sun_direction; // the way its light travels
    float shadow_texel; // of the shadow map, in its coordinates
    vec3 sun_irradiance; // on a surface that faces it
    float pad0;
} frame;

layout(set = 0, binding = 1, std430) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = 2, std430) readonly buffer Placings { Placing placings[]; };

vec3 world_position(uint vertex, uint instance) {
    vec4 p = vec4(vertices[vertex].position, 1.0);
    Placing placing = placings[instance];
    return vec3(dot(placing.object_to_world[0], p), dot(placing.object_to_world[1], p),
                dot(placing.object_to_world[2], p));
}
