"""The thesis's station as its appendix E reads: one object, loops, `if` after `if`, NumPy where it
has matrices.

It shares no line with `tandem.lab.kinat2023`, so that the two can judge each other. Nothing is
clever here.
"""

from __future__ import annotations

import numpy as np

ROBOT, HUMAN = 0, 1


class ThesisPort:
    """`reset()`, then `step(action)` until `done`. `C[i, j] == 1`: task i + 1 waits for task j
    + 1.
    """

    def __init__(self, t_R, t_H, e, C, rewards):
        self.t_R0, self.t_H0 = np.array(t_R), np.array(t_H)
        self.e = np.array(e, np.float32)
        self.C0 = np.array(C, int)
        self.n = len(self.t_R0)
        self.pay = rewards

    def reset(self):
        self.task = [0, 0]  # what robot and human are doing
        self.t = [self.t_R0.copy(), self.t_H0.copy()]
        for agent in (ROBOT, HUMAN):  # the assignment counts as one step
            for i in range(self.n):
                if self.t[agent][i] != 0:
                    self.t[agent][i] = self.t[agent][i] - 1
        self.C = self.C0.copy()
        self.ended = np.zeros(self.n, bool)
        self.clock = 0
        self.stress = np.float32(0)
        self.done = False

    def step(self, action):  # noqa: C901
        action = [int(action[ROBOT]), int(action[HUMAN])]
        reward = np.array([self.pay["step"], self.pay["step"]], np.float32)
        illegal = [False, False]

        for agent in (ROBOT, HUMAN):
            if self.task[agent] == 0 and action[agent] == 0:
                reward[agent] += self.pay["idle"]
            if action[agent] != 0:
                i = action[agent] - 1
                if self.task[agent] != 0:
                    reward[agent] += self.pay["illegal"]
                    illegal[agent] = True
                if np.sum(self.C[i, :]) > 0:
                    reward[agent] += self.pay["illegal"]
                    illegal[agent] = True
                if self.t[agent][i] == 0:
                    reward[agent] += self.pay["illegal"]
                    illegal[agent] = True
                if illegal[agent]:
                    action[agent] = 0

        for agent in (ROBOT, HUMAN):
            if not illegal[agent] and self.task[agent] != 0:
                i = self.task[agent] - 1
                self.t[agent][i] = self.t[agent][i] - 1
                if self.t[agent][i] == 0:
                    self.task[agent] = 0
                    self.C[:, i] = 0
                    self.ended[i] = True
                    reward[agent] += self.pay["task_done"]

        if action[ROBOT] == action[HUMAN]:
            action[ROBOT] = 0

        for agent in (ROBOT, HUMAN):
            if action[agent] != 0:
                i = action[agent] - 1
                self.task[agent] = i + 1
                self.t[1 - agent][i] = 0
                if agent == ROBOT:
                    reward[agent] += self.e[i] * self.pay["stress_factor"]
                else:
                    reward[agent] -= self.e[i] * self.pay["stress_factor"]
                    self.stress += self.e[i]

        self.clock += 1
        if np.sum(self.t[ROBOT]) + np.sum(self.t[HUMAN]) == 0:
            self.done = True
            reward += self.pay["all_done"]
        return reward, self.done
