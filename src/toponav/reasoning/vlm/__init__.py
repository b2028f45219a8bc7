"""A vision-language model as the reasoner: what is asked, how, and what becomes of the answers.

`prompt` and its neighbours say what is asked (pure functions), `chat` declares the seam to a
server, `model_client` asks until there is a usable answer, and `vlm_reasoner` is the `Reasoner`.
"""
