"""Self-play under a tree search: the network, the searches, the training; and all of it as Yu,
Huang and Chang (2020) described it.
"""
