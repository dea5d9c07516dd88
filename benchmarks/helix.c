/* The surrogate's helix in C: quadrature and 6x6 solve of one design after the other.
 *
 * The same formulas as microswim/kernels.py, written for the C compiler: the yardstick of
 * bench_surrogate.py. p: L, b, k, ramp, sign, c_t, c_n, c_r, offset, spin. out: the twist. */
#include <math.h>

void designs(int n, const double *params, const double *bodies, int m0, const double *x0,
             const double *w0, int m1, const double *x1, const double *w1, double *out) {
    for (int d = 0; d < n; d++) {
        const double *p = params + 10 * d;
        double L = p[0], b = p[1], k = p[2], ramp = p[3], sign = p[4];
        double c_t = p[5], c_n = p[6], c_r = p[7], offset = p[8], spin = p[9];
        double R[6][6] = {{0}}, F[6] = {0};
        for (int panel = 0; panel < 2; panel++) {
            int m = panel ? m1 : m0;
            const double *xi = panel ? x1 : x0, *w = panel ? w1 : w0;
            double start = panel ? ramp : 0, width = panel ? 1 - ramp : ramp;
            for (int i = 0; i < m; i++) {
                double x = start + width * xi[i], s = x * L;
                double a = panel ? b : b * x / ramp, da = panel ? 0 : b / (ramp * L);
                double c = cos(k * s), e = sin(k * s);
                double q = a * c, q_s = da * c - a * k * e, u = a * e;
                double r = -sign * a * e, r_s = -sign * (da * e + a * k * c), v = sign * a * c;
                double speed = sqrt(1 + q_s * q_s + r_s * r_s);
                double dl = w[i] * width * L * speed, N = c_n * dl, D = (c_t - c_n) * dl, S = c_r * dl;
                double X = s + offset;
                double g[6] = {1 / speed, q_s / speed, r_s / speed};
                g[3] = q * g[2] - r * g[1];
                g[4] = r * g[0] - X * g[2];
                g[5] = X * g[1] - q * g[0];
                for (int row = 0; row < 6; row++)
                    for (int col = 0; col <= row; col++) R[row][col] += D * g[row] * g[col];
                for (int row = 0; row < 3; row++) {
                    R[row][row] += N;
                    for (int col = 0; col <= row; col++) R[3 + row][3 + col] += S * g[row] * g[col];
                }
                R[3][3] += N * (q * q + r * r);
                R[4][4] += N * (X * X + r * r);
                R[5][5] += N * (X * X + q * q);
                R[4][3] -= N * X * q;
                R[5][3] -= N * X * r;
                R[5][4] -= N * q * r;
                R[3][1] -= N * r;
                R[3][2] += N * q;
                R[4][0] += N * r;
                R[4][2] -= N * X;
                R[5][0] -= N * q;
                R[5][1] += N * X;
                double along = D * (g[1] * u + g[2] * v), twist = S * g[0] * spin;
                double f0 = along * g[0], f1 = N * u + along * g[1], f2 = N * v + along * g[2];
                F[0] += f0;
                F[1] += f1;
                F[2] += f2;
                F[3] += q * f2 - r * f1 + twist * g[0];
                F[4] += r * f0 - X * f2 + twist * g[1];
                F[5] += X * f1 - q * f0 + twist * g[2];
            }
        }
        double *V = out + 6 * d;
        for (int i = 0; i < 6; i++) {
            V[i] = -F[i];
            for (int j = 0; j <= i; j++) R[i][j] += bodies[36 * d + 6 * i + j];
        }
        for (int j = 0; j < 6; j++) {
            double inverse = 1 / R[j][j];
            for (int i = j + 1; i < 6; i++) {
                double ratio = R[i][j] * inverse;
                for (int m = j + 1; m <= i; m++) R[i][m] -= ratio * R[m][j];
                V[i] -= ratio * V[j];
                R[j][i] = ratio;
            }
            V[j] *= inverse;
        }
        for (int j = 4; j >= 0; j--)
            for (int i = j + 1; i < 6; i++) V[j] -= R[j][i] * V[i];
    }
}
