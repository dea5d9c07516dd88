/* The surrogate in C: quadrature and 6x6 solve, LANES designs at a time.
 *
 * The same formulas as models/rft/segment.py with explicit lanes, so that the compiler takes the
 * designs of one block side by side, sines included: the yardstick of bench_surrogate.py.
 * p (n, 10): L, b, k, ramp, sign, c_t, c_n, c_r, offset, spin; a plane wave has sign and spin 0.
 * out (n, m, 6): the twist at each of m phases. */
#include <math.h>

#define LANES 16
#define EACH _Pragma("omp simd") for (int l = 0; l < LANES; l++)
typedef double lanes[LANES];

static void segment(lanes R[restrict 6][6], lanes F[restrict 6], const lanes p[restrict 10],
                    double x, double weight, int ramp, double phase) {
    lanes cosine, sine; /* apart: GCC joins a pair into sincos, which has no lanes */
    EACH cosine[l] = cos(p[2][l] * (ramp ? p[3][l] * x : p[3][l] + (1 - p[3][l]) * x) * p[0][l] - phase);
    EACH sine[l] = sin(p[2][l] * (ramp ? p[3][l] * x : p[3][l] + (1 - p[3][l]) * x) * p[0][l] - phase);
    EACH {
        double L = p[0][l], b = p[1][l], k = p[2][l], part = p[3][l], sign = p[4][l], spin = p[9][l];
        double xi = ramp ? part * x : part + (1 - part) * x, width = ramp ? part : 1 - part;
        double s = xi * L, a = ramp ? b * x : b, da = ramp ? b / (part * L) : 0;
        double c = cosine[l], e = sine[l];
        double q = a * c, q_s = da * c - a * k * e, u = a * e;
        double r = -sign * a * e, r_s = -sign * (da * e + a * k * c), v = sign * a * c;
        double v2 = 1 + q_s * q_s + r_s * r_s, speed = sqrt(v2), inverse = 1 / speed;
        double dl = weight * width * L * speed;
        double N = p[6][l] * dl, D = (p[5][l] - p[6][l]) * dl, S = p[7][l] * dl, X = s + p[8][l];
        double g0 = inverse, g1 = q_s * inverse, g2 = r_s * inverse;
        double g3 = q * g2 - r * g1, g4 = r * g0 - X * g2, g5 = X * g1 - q * g0;
        double along = D * (g1 * u + g2 * v), twist = S * g0 * spin;
        double f0 = along * g0, f1 = N * u + along * g1, f2 = N * v + along * g2;
        R[0][0][l] += D * g0 * g0 + N;
        R[1][0][l] += D * g1 * g0;
        R[1][1][l] += D * g1 * g1 + N;
        R[2][0][l] += D * g2 * g0;
        R[2][1][l] += D * g2 * g1;
        R[2][2][l] += D * g2 * g2 + N;
        R[3][0][l] += D * g3 * g0;
        R[3][1][l] += D * g3 * g1 - N * r;
        R[3][2][l] += D * g3 * g2 + N * q;
        R[3][3][l] += D * g3 * g3 + S * g0 * g0 + N * (q * q + r * r);
        R[4][0][l] += D * g4 * g0 + N * r;
        R[4][1][l] += D * g4 * g1;
        R[4][2][l] += D * g4 * g2 - N * X;
        R[4][3][l] += D * g4 * g3 + S * g1 * g0 - N * X * q;
        R[4][4][l] += D * g4 * g4 + S * g1 * g1 + N * (X * X + r * r);
        R[5][0][l] += D * g5 * g0 - N * q;
        R[5][1][l] += D * g5 * g1 + N * X;
        R[5][2][l] += D * g5 * g2;
        R[5][3][l] += D * g5 * g3 + S * g2 * g0 - N * X * r;
        R[5][4][l] += D * g5 * g4 + S * g2 * g1 - N * q * r;
        R[5][5][l] += D * g5 * g5 + S * g2 * g2 + N * (X * X + q * q);
        F[0][l] += f0;
        F[1][l] += f1;
        F[2][l] += f2;
        F[3][l] += q * f2 - r * f1 + twist * g0;
        F[4][l] += r * f0 - X * f2 + twist * g1;
        F[5][l] += X * f1 - q * f0 + twist * g2;
    }
}

static void ldl(lanes R[6][6], lanes V[6]) {
    lanes inverse, ratio;
    for (int j = 0; j < 6; j++) {
        EACH inverse[l] = 1 / R[j][j][l];
        for (int i = j + 1; i < 6; i++) {
            EACH ratio[l] = R[i][j][l] * inverse[l];
            for (int m = j + 1; m <= i; m++) EACH R[i][m][l] -= ratio[l] * R[m][j][l];
            EACH V[i][l] -= ratio[l] * V[j][l];
            EACH R[j][i][l] = ratio[l];
        }
        EACH V[j][l] *= inverse[l];
    }
    for (int j = 4; j >= 0; j--)
        for (int i = j + 1; i < 6; i++) EACH V[j][l] -= R[j][i][l] * V[i][l];
}

void designs(int n, const double *params, const double *bodies, int m0, const double *x0,
             const double *w0, int m1, const double *x1, const double *w1, int m,
             const double *phases, double *out) {
    for (int d = 0; d < n; d += LANES) {
        lanes p[10], R[6][6], F[6];
        int at[LANES];
        for (int l = 0; l < LANES; l++) {
            at[l] = d + l < n ? d + l : n - 1;
            for (int i = 0; i < 10; i++) p[i][l] = params[10 * at[l] + i];
        }
        for (int j = 0; j < m; j++) {
            for (int l = 0; l < LANES; l++) {
                for (int i = 0; i < 36; i++) R[i / 6][i % 6][l] = bodies[36 * at[l] + i];
                for (int i = 0; i < 6; i++) F[i][l] = 0;
            }
            for (int i = 0; i < m0; i++) segment(R, F, p, x0[i], w0[i], 1, phases[j]);
            for (int i = 0; i < m1; i++) segment(R, F, p, x1[i], w1[i], 0, phases[j]);
            ldl(R, F);
            for (int l = 0; l < LANES && d + l < n; l++)
                for (int i = 0; i < 6; i++) out[6 * (m * (d + l) + j) + i] = -F[i][l];
        }
    }
}
