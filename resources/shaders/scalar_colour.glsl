// The colour of what a surface is coloured by, at a place in grid index units; put before the fragment shaders that ask
// for it by name. ui/render/colour_uniforms.cpp sets what it needs.
uniform int scalarKind;        // 0: none; 1: along an axis; 2: a length; 3: a field
uniform vec4 scalarRows[3];    // with the place: 1: the value; 2: what the length is of; 3: the place in the field
uniform vec2 scalarScale;      // from a value to its place on the map: x * value + y
uniform sampler3D scalarField; // huge where something is missing
uniform sampler2D colourMap;   // as seen, in one row

// Linear light.
vec3 scalarColour(vec3 gridPlace) {
    vec4 place = vec4(gridPlace, 1.0);
    vec3 scalars = vec3(dot(scalarRows[0], place), dot(scalarRows[1], place), dot(scalarRows[2], place));
    float value = scalars.x;
    if (scalarKind == 2)
        value = length(scalars);
    else if (scalarKind == 3)
        value = textureLod(scalarField, scalars, 0.0).r;
    if (value > 1e6 && scalarKind == 3)
        return pow(vec3(0.5), vec3(2.2)); // neutral: nothing is known
    float on = clamp(scalarScale.x * value + scalarScale.y, 0.0, 1.0);
    float colours = float(textureSize(colourMap, 0).x);
    return pow(textureLod(colourMap, vec2((on * (colours - 1.0) + 0.5) / colours, 0.5), 0.0).rgb, vec3(2.2));
}
