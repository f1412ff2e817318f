#version 330 core
// Wide edges of triangles, as rectangles in the plane of each: what is behind the triangle is behind its edges.
layout(triangles) in;
layout(triangle_strip, max_vertices = 12) out;

uniform vec2 viewportPixels;
uniform float lineWidth; // pixels
uniform vec4 cuts[7]; // as for the triangles
uniform int cutCount;

in vec3 viewPosition[];
in vec3 viewNormal[];
in vec3 gridPosition[];
in float leafLevel[];
flat in vec4 tintColour[];

out vec3 edgePosition;
out vec3 edgeNormal;
out vec3 edgeGridPosition;
out float edgeLevel;
flat out vec4 edgeTint;
out float gl_ClipDistance[7];

vec2 depthSlope = vec2(0.0); // of the triangle, by its place in the picture, both normalised
float greatestStep = 0.0; // of depth in the triangle
float side = 1.0; // rectangles face the way that the triangle does

float nearness(int corner) { // above 0 in front of the near plane
    return gl_in[corner].gl_Position.z + gl_in[corner].gl_Position.w;
}

void lookAtTriangle() {
    if (min(min(nearness(0), nearness(1)), nearness(2)) <= 0.0)
        return;
    vec3 first = gl_in[0].gl_Position.xyz / gl_in[0].gl_Position.w;
    vec3 u = gl_in[1].gl_Position.xyz / gl_in[1].gl_Position.w - first;
    vec3 v = gl_in[2].gl_Position.xyz / gl_in[2].gl_Position.w - first;
    float area = u.x * v.y - u.y * v.x;
    side = area < 0.0 ? -1.0 : 1.0;
    greatestStep = max(max(abs(u.z), abs(v.z)), abs(u.z - v.z));
    if (area != 0.0)
        depthSlope = vec2(u.z * v.y - u.y * v.z, u.x * v.z - u.z * v.x) / area;
}

void emitAt(int from, int to, float share, vec2 further) {
    vec4 place = mix(gl_in[from].gl_Position, gl_in[to].gl_Position, share);
    float depth = clamp(dot(depthSlope, further), -greatestStep, greatestStep);
    gl_Position = place + vec4(further, depth, 0.0) * place.w;
    edgePosition = mix(viewPosition[from], viewPosition[to], share);
    edgeNormal = mix(viewNormal[from], viewNormal[to], share);
    edgeGridPosition = mix(gridPosition[from], gridPosition[to], share);
    edgeLevel = mix(leafLevel[from], leafLevel[to], share);
    edgeTint = tintColour[2]; // the last is the one that counts
    for (int i = 0; i < cutCount; ++i)
        gl_ClipDistance[i] = dot(cuts[i].xyz, edgeGridPosition) + cuts[i].w;
    EmitVertex();
}

void drawEdge(int from, int to) {
    float fromNear = nearness(from), toNear = nearness(to);
    if (fromNear <= 0.0 && toNear <= 0.0)
        return;
    float crossing = fromNear / (fromNear - toNear);
    float first = fromNear < 0.0 ? crossing : 0.0, last = toNear < 0.0 ? crossing : 1.0;
    vec4 begin = mix(gl_in[from].gl_Position, gl_in[to].gl_Position, first);
    vec4 end = mix(gl_in[from].gl_Position, gl_in[to].gl_Position, last);
    vec2 way = (end.xy / end.w - begin.xy / begin.w) * viewportPixels;
    vec2 along = length(way) > 0.0 ? normalize(way) : vec2(1.0, 0.0);
    vec2 ahead = along * lineWidth / viewportPixels;
    vec2 aside = side * vec2(-along.y, along.x) * lineWidth / viewportPixels;
    emitAt(from, to, first, aside - ahead);
    emitAt(from, to, first, -aside - ahead);
    emitAt(from, to, last, aside + ahead);
    emitAt(from, to, last, ahead - aside);
    EndPrimitive();
}

void main() {
    if (gl_in[0].gl_Position == gl_in[1].gl_Position && gl_in[1].gl_Position == gl_in[2].gl_Position)
        return; // a hidden piece
    lookAtTriangle();
    drawEdge(0, 1);
    drawEdge(1, 2);
    drawEdge(2, 0);
}
