"""The shaders: what `shading.shade` computes, a pixel at a time on the device.

Light constants are those of `shading`, pasted in. The texels of all textures lie in one table, and
every corner knows its face's part of it: one draw call then serves all materials.
"""

from __future__ import annotations

from toponav.envs.simulator import shading

NEAR_M = 0.01
"""Surfaces nearer to the image plane than this are not drawn. The depth buffer holds
1 - NEAR_M / z: with 24 bits it tells 1 mm apart at 12 m."""

UNIT_NORMAL = 32767
"""A length of 1 in the 16-bit integers that normals are handed over in."""

_VERTEX = """
uniform mat3 camera_from_world;
uniform vec3 center;   // the mesh's origin in the camera frame, metres
uniform vec3 eye;      // from the mesh's centre, metres
uniform vec4 lens;     // scale along x and y, shift along x and y: to clip coordinates
uniform float near;
in vec3 position;      // metres, from the mesh's centre
in ivec4 whole_normal; // of the face, of length UNIT_NORMAL; the fourth is unused
in vec2 uv;
in ivec4 look;         // of the face: its texture's first texel, columns and rows; its instance
in vec3 tint;
flat out float base_light;
flat out float eye_distance;
flat out ivec4 seen_look;
out vec2 seen_uv;
out vec3 seen_tint;
out vec3 ray;          // from the eye, metres

void main() {
    vec3 normal = vec3(whole_normal.xyz) / UNIT_NORMAL;
    ray = position - eye;
    float away = dot(normal, ray);
    vec3 n = away > 0.0 ? -normal : normal;  // seen from behind: light the side that is seen
    base_light = AMBIENT + SKY * (0.5 + 0.5 * n.z) + BOUNCE * max(0.0, -n.z)
        + SIDE * (0.5 + 0.5 * dot(n, SIDE_DIRECTION));
    eye_distance = abs(away);
    seen_look = look;
    seen_uv = uv;
    seen_tint = tint;
    vec3 p = camera_from_world * position + center;
    // Row 0 of the image is row 0 of the target: nothing needs to be flipped when read.
    gl_Position = vec4(lens.xy * p.xy + lens.zw * p.z, p.z - 2.0 * near, p.z);
}
"""

_FRAGMENT = """
uniform sampler2D texels;
flat in float base_light;
flat in float eye_distance;
flat in ivec4 seen_look;
in vec2 seen_uv;
in vec3 seen_tint;
in vec3 ray;
layout(location = 0) out vec4 rgb;
layout(location = 1) out float depth;
layout(location = 2) out int instance;

void main() {
    depth = 1.0 / gl_FragCoord.w;
    instance = seen_look.w;
    ivec2 size = seen_look.yz;
    vec2 part = fract(seen_uv);
    ivec2 place = min(ivec2(vec2(part.x, 1.0 - part.y) * vec2(size)), size - 1);
    int texel = seen_look.x + place.y * size.x + place.x;
    ivec2 entry = ivec2(texel & ((1 << COLUMN_BITS) - 1), texel >> COLUMN_BITS);
    vec3 color = texelFetch(texels, entry, 0).rgb;
    if (TINTED) color *= seen_tint;
    if (LIT) {
        float range = length(ray);
        float light = base_light + HEADLIGHT * eye_distance / range;
        color *= light * max(0.5, 1.0 - FALLOFF_PER_M * range);
    }
    rgb = vec4(color, 1.0);
}
"""


def program_sources(lit: bool, tinted: bool, column_bits: int) -> tuple[str, str]:
    """The vertex and the fragment shader of a scene.

    Args:
        lit: Whether its surfaces are lit.
        tinted: Whether colours of corners multiply its textures.
        column_bits: The table of texels is 2 ** column_bits wide.
    """
    constants = {
        "AMBIENT": shading.AMBIENT,
        "SKY": shading.SKY,
        "BOUNCE": shading.BOUNCE,
        "SIDE": shading.SIDE,
        "SIDE_DIRECTION": f"vec3{shading.SIDE_DIRECTION}",
        "HEADLIGHT": shading.HEADLIGHT,
        "FALLOFF_PER_M": shading.FALLOFF_PER_M,
        "UNIT_NORMAL": float(UNIT_NORMAL),
        "COLUMN_BITS": column_bits,
        "LIT": str(lit).lower(),
        "TINTED": str(tinted).lower(),
    }
    defines = "".join(f"#define {name} {value}\n" for name, value in constants.items())
    head = "#version 330\n" + defines
    return head + _VERTEX, head + _FRAGMENT
