#version 330 core
// Wide lines as rectangles that look at the viewer, half their width longer at each end so that corners meet.
layout(lines) in;
layout(triangle_strip, max_vertices = 4) out;

uniform vec2 viewportPixels;
uniform float lineWidth; // pixels

void main() {
    vec4 from = gl_in[0].gl_Position, to = gl_in[1].gl_Position;
    float fromNear = from.z + from.w, toNear = to.z + to.w; // above 0 in front of the near plane
    if (fromNear <= 0.0 && toNear <= 0.0)
        return;
    vec4 crossing = mix(from, to, fromNear / (fromNear - toNear));
    if (fromNear < 0.0)
        from = crossing;
    else if (toNear < 0.0)
        to = crossing;
    vec2 way = (to.xy / to.w - from.xy / from.w) * viewportPixels;
    vec2 along = length(way) > 0.0 ? normalize(way) : vec2(1.0, 0.0);
    vec2 ahead = along * lineWidth / viewportPixels, aside = vec2(-along.y, along.x) * lineWidth / viewportPixels;
    gl_Position = from + vec4((aside - ahead) * from.w, 0.0, 0.0);
    EmitVertex();
    gl_Position = from + vec4((-aside - ahead) * from.w, 0.0, 0.0);
    EmitVertex();
    gl_Position = to + vec4((aside + ahead) * to.w, 0.0, 0.0);
    EmitVertex();
    gl_Position = to + vec4((ahead - aside) * to.w, 0.0, 0.0);
    EmitVertex();
    EndPrimitive();
}
