# A thin door to dev.py, which says what each verb does.
PYTHON ?= python3

.PHONY: run test lint fix docs bench house fuzz clean
run test lint fix docs bench house fuzz clean:
	@$(PYTHON) dev.py $@
