// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of a banded exact distance transform that all its passes share. Rows of sites and links between columns are
// 16-bit numbers; kNoIndex stands for none.
// Based on [Cao10]: T.-T. Cao, K. Tang, A. Mohamed, T.-S. Tan, Parallel Banding Algorithm to compute exact distance
// transform with the GPU, 2010. Differences: any rectangle; ties are decided (lowest row, then leftmost); the predicate
// is a division rounded down, exact in 32 bits up to sides of 16384.
#pragma once

const uint kNoIndex = 0xFFFFu;

/// What column `x` offers to a row of pixels: the row of its nearest site, and the square of the distance there.
struct Offer {
    int x;
    int site_y;
    int square;
};

Offer make_offer(int x, uint site_y, int y) {
    int apart = int(site_y) - y;
    return Offer(x, int(site_y), apart * apart);
}

int offer_square(Offer offer, int x) { return (x - offer.x) * (x - offer.x) + offer.square; }

/// Is the right one's site nearer to pixel `x`, or as near and lower?
bool wins(Offer right, Offer left, int x) {
    int to_right = offer_square(right, x), to_left = offer_square(left, x);
    return to_right < to_left || (to_right == to_left && right.site_y < left.site_y);
}

/// The first pixel that the right one wins against the left one, from left.x < right.x; may lie outside the picture.
int first_win(Offer left, Offer right) {
    int tie = right.site_y < left.site_y ? 1 : 0;
    int numerator = right.x * right.x - left.x * left.x + right.square - left.square - tie;
    int denominator = 2 * (right.x - left.x);
    int quotient = numerator / denominator;
    return (quotient * denominator > numerator ? quotient - 1 : quotient) + 1;
}

/// Does the middle one own no pixel at all?
bool is_useless(Offer left, Offer middle, Offer right) {
    return first_win(middle, right) <= first_win(left, middle);
}

uint pack_pair(uint low, uint high) { return low | high << 16; }
uint low_of(uint pair) { return pair & 0xFFFFu; }
uint high_of(uint pair) { return pair >> 16; }
