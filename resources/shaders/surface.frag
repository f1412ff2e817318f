#version 330 core
// Two-sided: a key light, a headlight, a cool fill from below right.
#ifdef WIDE_EDGES // what edges.geom makes of them
#define viewPosition edgePosition
#define viewNormal edgeNormal
#define gridPosition edgeGridPosition
#define leafLevel edgeLevel
#define tintColour edgeTint
#endif
in vec3 viewPosition;
in vec3 viewNormal;
in vec3 gridPosition; // grid index units
in float leafLevel; // of the leaf edge on which a vertex lies
flat in vec4 tintColour; // of the piece; a: how much of it counts

uniform vec3 frontColour; // linear light
uniform vec3 backColour;
uniform vec4 highlightColour;  // a: how much of it covers the surface
uniform vec4 spot;        // grid index units: middle and radius of what is highlighted
uniform vec4 spotColour;  // a: how much of it covers the surface
uniform vec3 levelColours[4];
uniform float tintShare; // 0: there are no tints
uniform float levelShare; // 1: surface coloured by level, 0: not
uniform float perspective; // 1 perspective, 0 orthographic
uniform vec3 keyDirection; // unit vector
uniform vec3 lightShares; // of key light, headlight and fill

#ifdef PEELING // see ui/render/transparent_layers.h
uniform sampler2D opaqueDepth;
uniform sampler2D peeledDepth; // of the layer before
uniform float opacity;
#endif

out vec4 colour;

vec3 shadingNormal() {
    float size = length(viewNormal);
    // Where the gradient vanishes the facet's own normal serves.
    vec3 facet = cross(dFdx(viewPosition), dFdy(viewPosition));
    vec3 normal = size > 1e-4 ? viewNormal / size : normalize(facet + vec3(0.0, 0.0, 1e-20));
    return normal;
}

vec3 surfaceColour() {
    if (scalarKind == 0)
        return gl_FrontFacing ? frontColour : backColour;
    return scalarColour(gridPosition) * (gl_FrontFacing ? 1.0 : 0.45);
}

void main() {
    vec3 toViewer = perspective > 0.5 ? normalize(-viewPosition) : vec3(0.0, 0.0, 1.0);
    vec3 normal = shadingNormal();
#ifdef PEELING
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = gl_FragCoord.z;
    if (depth <= texelFetch(peeledDepth, pixel, 0).r || depth >= texelFetch(opaqueDepth, pixel, 0).r)
        discard;
    gl_FragDepth = depth; // exactly what the next layer compares with
#endif
    if (!gl_FrontFacing)
        normal = -normal;
    vec3 base = surfaceColour();
    base = mix(base, tintColour.rgb * (gl_FrontFacing ? 1.0 : 0.45), tintShare * tintColour.a);
    float level = clamp(leafLevel, 0.0, 2.999);
    vec3 ofLevel = mix(levelColours[int(level)], levelColours[int(level) + 1], fract(level));
    base = mix(base, ofLevel * (gl_FrontFacing ? 1.0 : 0.45), levelShare);

    const vec3 fillDirection = normalize(vec3(0.75, -0.45, 0.35));
    float key = max(dot(normal, keyDirection), 0.0);
    float head = max(dot(normal, toViewer), 0.0);
    float fill = max(dot(normal, fillDirection), 0.0);
    float sky = 0.5 + 0.5 * normal.y;

    vec3 light = vec3(0.055) + 0.05 * sky * vec3(0.9, 0.95, 1.0);
    light += lightShares.x * key * vec3(1.0, 0.97, 0.92);
    light += lightShares.y * head;
    light += lightShares.z * fill * vec3(0.75, 0.85, 1.0);

    vec3 halfway = normalize(keyDirection + toViewer);
    float shine = pow(max(dot(normal, halfway), 0.0), 48.0) * 0.16;
    shine += pow(max(dot(normal, toViewer), 0.0), 90.0) * 0.05;
    vec3 lit = base * light + vec3(shine) * (gl_FrontFacing ? 1.0 : 0.3);

    vec3 highlight = highlightColour.rgb * (0.25 + 0.75 * head);
    lit = mix(lit, highlight, highlightColour.a);
    float inSpot = 1.0 - smoothstep(0.8 * spot.w, spot.w, distance(gridPosition, spot.xyz));
    lit = mix(lit, spotColour.rgb * (0.25 + 0.75 * head), spotColour.a * inSpot);
    colour = vec4(pow(min(lit, vec3(1.0)), vec3(1.0 / 2.2)), 1.0);
#ifdef PEELING
    colour *= opacity;
#endif
}
