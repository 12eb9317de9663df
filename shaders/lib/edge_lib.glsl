// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Where a map texel lies against a silhouette edge, and which of several edges a texel should remember.
// Everything is in texels of the map; an edge is the segment from `start` to `end`.
// Based on: [Kenzel13] 3.1 (lines and distances) and 3.2.3 (sorting).
// Differences: distances are taken to the segment's nearer end, so that two edges that share a vertex get bit-identical
// distances to it; the order is derived anew below, because Eq. 3.8 as printed reduces to min |p.e|.

const int kEdgeOrderStream = 0;     // last drawn wins
const int kEdgeOrderMin = 1;        // smallest distance to the line
const int kEdgeOrderThesis = 2;     // the working reading of [Kenzel13] Eq. 3.8
const int kEdgeOrderCorrected = 3;  // distance to the segment, then orthogonality

struct EdgeSample {
    vec2 normal;             // unit, of the line
    float line_distance;     // signed, along `normal`
    float segment_distance;  // >= |line_distance|
    float end_distance;      // to the nearer end
    float overshoot;         // > 0: how far the sample lies past the nearer end, measured along the edge
    float fraction;          // foot point on the segment, 0 at start .. 1 at end
};

// A zero-length edge acts as a point: its normal points at the sample.
EdgeSample sample_edge(vec2 point, vec2 start, vec2 end) {
    vec2 along = end - start;
    float len = length(along);
    vec2 to_start = point - start;
    vec2 to_end = point - end;
    bool start_nearer = dot(to_start, to_start) <= dot(to_end, to_end);
    vec2 offset = start_nearer ? to_start : to_end;

    EdgeSample result;
    result.end_distance = length(offset);
    vec2 direction = len > 0.0 ? along / len
                   : result.end_distance > 0.0 ? vec2(-offset.y, offset.x) / result.end_distance : vec2(1.0, 0.0);
    // [Kenzel13] Eq. 3.7 gives (a, b) = (y1 - y2, x2 - x1); Eq. 3.3 needs it divided by sqrt(a^2 + b^2) to be a
    // distance.
    result.normal = vec2(-direction.y, direction.x);
    result.line_distance = dot(offset, result.normal);
    float run = dot(offset, direction);
    result.overshoot = start_nearer ? -run : run;
    result.segment_distance = result.overshoot >= 0.0 ? result.end_distance : abs(result.line_distance);
    result.fraction = len > 0.0 ? clamp(dot(to_start, direction) / len, 0.0, 1.0) : 0.0;
    return result;
}

// [Kenzel13] Eq. 3.8 compares a cosine with a distance; p.e with e = (a, b, c) makes (p - p0).e = p.e, so as printed
// both branches are |p.e|. The reading that gives the cone of figure 3.8: past an end, the cosine between the way from
// the corner and the edge's own direction.
float thesis_priority(EdgeSample edge) {
    float distance_to_line = abs(edge.line_distance);
    if (edge.overshoot <= 0.0 || edge.end_distance <= 0.0) return distance_to_line;
    return max(edge.overshoot / edge.end_distance, distance_to_line);
}

// The order wanted: first the edge whose segment is nearest. Two edges that meet in a vertex tie wherever that vertex
// is the nearest point of both; there the line that separates better is the one that the way to the vertex is more
// orthogonal to, which is the one with the larger distance to its *line*. Ties are exact (see sample_edge), so a small
// weight makes one number of the pair; it can only change the order of edges whose distances differ by less than it.
const float kOrthogonalityWeight = 1.0 / 256.0;
float corrected_priority(EdgeSample edge) {
    return edge.segment_distance + kOrthogonalityWeight * (edge.segment_distance - abs(edge.line_distance));
}

// Smaller wins.
float edge_priority(int order, EdgeSample edge) {
    if (order == kEdgeOrderCorrected) return corrected_priority(edge);
    if (order == kEdgeOrderThesis) return thesis_priority(edge);
    if (order == kEdgeOrderMin) return abs(edge.line_distance);
    return 0.0;
}
